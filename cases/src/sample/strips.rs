//! A deposit in strips, side by side, of which each can be made without the others: as many discs as a strip and the seam at its right
//! should have, in its own order, whoever makes it.
//!
//! Each strip is laid on its own between straight sides, from a stream of random numbers of its own. Between two strips a seam is
//! left, which is filled up to their surface with discs that touch both. What is then too much, the highest discs of strip and
//! seam, is taken away; so all strips are about as high, and the sample has its number of grains.

use crate::sample::deposit::{self, Disc, Seam};
use crate::sample::sizes::{Radii, with_room};
use contact::shown;
use std::ops::Range;

/// A deposit in strips.
#[derive(Clone, Copy)]
pub struct Strips<'s> {
    pub(crate) radii: Radii<'s>,
    pub(crate) seed: u64,
    pub(crate) grains: u32,
    pub(crate) count: u32,
    /// Width of the box (m).
    pub(crate) width: f64,
}

/// Width of a seam, and the least width of a strip with its seam, over the greatest radius (–).
const SEAM: f64 = 4.0;
const LEAST: f64 = 24.0;

/// Distance from their border within which the discs of two strips matter to the other's contacts and subdomains, over the greatest
/// radius (–).
const REACH: f64 = 12.0;

impl Strips<'_> {
    /// Refuses strips that are too narrow.
    pub(crate) fn check(&self) -> Result<(), String> {
        let least = LEAST * self.greatest_radius();
        if self.pitch() < least {
            return Err(format!(
                "`sample.strips` is {}: strips are to be at least 24 greatest radii wide, {} m, and `scene.box.width_m` is {}",
                self.count,
                shown(least),
                shown(self.width)
            ));
        }
        match self.numbers(0).len().min(self.numbers(self.count - 1).len()) {
            0 => Err(format!("`sample.strips` is {}: a strip has no grain", self.count)),
            _ => Ok(()),
        }
    }

    /// Returns the number of strips.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// The greatest radius (m).
    pub fn greatest_radius(&self) -> f64 {
        self.radii.range[1]
    }

    /// Width of a strip with its seam (m).
    fn pitch(&self) -> f64 {
        (self.width + SEAM * self.greatest_radius()) / f64::from(self.count)
    }

    /// Returns the beginning of a strip, which is the end of the one before with its seam (m).
    fn start(&self, strip: u32) -> f64 {
        f64::from(strip) * self.pitch()
    }

    /// The numbers of the grains of a strip with its seam among all.
    pub fn numbers(&self, strip: u32) -> Range<u32> {
        let before = |strip: u32| {
            let share = self.start(strip) / self.width;
            if strip == self.count { self.grains } else { (f64::from(self.grains) * share) as u32 }
        };
        before(strip)..before(strip + 1)
    }

    /// The seam at the right of a strip.
    fn seam(&self, strip: u32) -> Seam {
        let (end, greatest) = (self.start(strip + 1), self.greatest_radius());
        Seam { ends: [end - SEAM * greatest, end], greatest, slack: 1e-12 * self.width }
    }

    /// The discs of a strip before there are any beside it.
    pub(crate) fn laid(&self, strip: u32) -> Result<Vec<Disc>, String> {
        let start = self.start(strip);
        let width = self.pitch() - SEAM * self.greatest_radius();
        let radii = self.radii.stream(self.seed, 2 * u64::from(strip))?.take(self.numbers(strip).len());
        let radii =
            with_room(radii.collect::<Result<_, _>>()?, self.greatest_radius(), None, &[("width_m", width)])?;
        let mut discs = deposit::deposit(&radii, width).map_err(no_place)?;
        for (x, _) in &mut discs {
            x.x += start;
        }
        Ok(discs)
    }

    /// Returns those of the discs `laid` in a strip that the seam at its left may touch.
    pub fn left_side(&self, strip: u32, laid: &[Disc]) -> Vec<Disc> {
        let seam = strip.checked_sub(1).map(|before| self.seam(before));
        laid.iter().filter(|disc| seam.as_ref().is_some_and(|seam| seam.is_beside(disc))).copied().collect()
    }

    /// The discs of a strip with its seam, which follows the side of the `next` one, if there is one.
    pub(crate) fn filled(&self, strip: u32, mut laid: Vec<Disc>, next: &[Disc]) -> Result<Vec<Disc>, String> {
        if strip + 1 == self.count {
            return Ok(laid);
        }
        let seam = self.seam(strip);
        let side: Vec<Disc> = laid.iter().filter(|disc| seam.is_beside(disc)).copied().collect();
        let radii = self.radii.stream(self.seed, 2 * u64::from(strip) + 1)?;
        laid.extend(seam.filled([&side, next], radii, no_place)?);
        // The highest are too many.
        let mut rising: Vec<usize> = (0..laid.len()).collect();
        rising.sort_by(|a, b| laid[*a].0.y.total_cmp(&laid[*b].0.y).then(a.cmp(b)));
        rising.truncate(self.numbers(strip).len());
        rising.sort_unstable();
        Ok(rising.into_iter().map(|k| laid[k]).collect())
    }

    /// Reports whether a disc of a strip matters to the strip at its left, and whether to that at its right.
    pub fn matters(&self, strip: u32, (at, _): &Disc) -> [bool; 2] {
        let reach = REACH * self.greatest_radius();
        [
            strip > 0 && at.x <= self.start(strip) + reach,
            strip + 1 < self.count && at.x >= self.start(strip + 1) - reach,
        ]
    }

    /// Returns all discs.
    pub(crate) fn whole(&self) -> Result<Vec<Disc>, String> {
        let mut all = Vec::with_capacity(self.grains as usize);
        let mut laid = self.laid(0)?;
        for strip in 0..self.count {
            let next = if strip + 1 < self.count { self.laid(strip + 1)? } else { Vec::new() };
            all.extend(self.filled(strip, laid, &self.left_side(strip + 1, &next))?);
            laid = next;
        }
        Ok(all)
    }
}

pub(crate) fn no_place(radius: f64) -> String {
    format!("`sample`: no place in the box holds a grain of radius {} m", shown(radius))
}

#[cfg(test)]
mod tests;
