//! Subdomains as a material, as a table.

use anyhow::Result;
use cases::Homogenised;
use lineup::OneProblem;
use partition::{Grid, Partition, Scheme};

/// A row for each subdomain of a partition, or one for all where there is none, from the impulses `r` (N·s), as CSV: of tensors in the
/// plane xx, yy and xy, in space zz, xz and yz too. Every body of a frozen problem counts as a grain.
///
/// # Errors
/// If the grid does not fit the problem.
pub(crate) fn homogenised(
    problem: &dyn OneProblem,
    partition: Option<(Grid, Scheme)>,
    r: &[f64],
) -> Result<String> {
    let (grid, scheme) = partition.unwrap_or((Grid::ONE, Scheme::Boxes));
    let (Partition { subdomain, count, .. }, _) = problem.cut(grid, scheme)?;
    let facts = problem.facts();
    let in_space = facts.dimensions > 2;
    let (of_stress, of_volume) = if in_space { ("n_per_m2", "volume_m3") } else { ("n_per_m", "area_m2") };
    let names: &[&str] = if in_space { &["xx", "yy", "zz", "xy", "xz", "yz"] } else { &["xx", "yy", "xy"] };
    let mut head = format!("subdomain,grains,{of_volume},coordination,pressure_{of_stress}");
    head.extend(names.iter().map(|name| format!(",stress_{name}_{of_stress}")));
    head.extend(names.iter().map(|name| format!(",fabric_{name}")));
    let mut text = head + "\n";
    let all = problem.homogenised(facts.grains, (&subdomain, count as usize), r);
    for (e, one) in all.iter().enumerate() {
        let Homogenised { grains, volume, coordination, stress, fabric } = one;
        text.extend([format!("{e},{grains},{volume},{coordination},{}", one.pressure(facts.dimensions))]);
        for tensor in [stress, fabric] {
            let shown: &[usize] = if in_space { &[0, 1, 2, 3, 4, 5] } else { &[0, 1, 3] };
            text.extend(shown.iter().map(|k| format!(",{}", tensor[*k])));
        }
        text.push('\n');
    }
    Ok(text)
}
