//! Properties of methods that no row holds, by their names.

use crate::read::RunRow;

impl RunRow {
    fn set(&self, key: &str) -> Option<&str> {
        self.settings.get(key)?.as_str()
    }

    /// The method that it is without subdomains.
    pub(crate) fn without_subdomains(&self) -> &str {
        if self.method == "nsgs-dd" { "nsgs" } else { &self.method }
    }

    /// Reports whether its iterates do not depend on a partition, though ranks share its work.
    pub(crate) fn is_shared_anyhow(&self) -> bool {
        self.method == "cg"
    }

    /// Solves with a factor of its whole matrix: LATIN-DD goes through those of all subdomains in each iteration, the active set
    /// through a new one.
    pub(crate) fn solves_with_factors(&self) -> Option<u64> {
        match self.method.as_str() {
            "latin-dd" => Some(self.iterations),
            "active-set" => Some(self.end.work.factorisations),
            _ => None,
        }
    }

    /// Exchanges with the neighbours in an iteration, and sums over all ranks, of the methods of which they are known.
    pub(crate) fn exchanges_and_sums(&self) -> Option<(f64, f64)> {
        match self.method.as_str() {
            "cg" => Some((self.end.work.delassus_products as f64 / self.iterations as f64, 4.0)),
            "latin-dd" => {
                let is_coarse = self.settings.get("coarse").is_some_and(|coarse| *coarse == true);
                Some((1.0, f64::from(u8::from(is_coarse))))
            }
            // The other exchange takes one for each colour.
            "nsgs-dd" => (self.set("exchange") != Some("gauss-seidel")).then_some((1.0, 0.0)),
            _ => None,
        }
    }
}
