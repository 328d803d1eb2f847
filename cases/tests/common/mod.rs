//! Scenes that tests write down.

use cases::Case;

/// A scene of discs, as [x, y, radius] (m), with time steps of `time_step_s` and what `rest` says of it.
pub(crate) fn scene_of_discs(discs: &str, time_step_s: f64, rest: &str) -> Result<Case, String> {
    let sample = format!("kind = \"discs\"\ndiscs = {discs}\ndensity_kg_per_m2 = 1000.0");
    scene_of(&sample, time_step_s, rest)
}

/// A scene of spheres, as [x, y, z, radius] (m), likewise.
#[allow(dead_code, reason = "not every test has spheres")]
pub(crate) fn scene_of_spheres(spheres: &str, time_step_s: f64, rest: &str) -> Result<Case, String> {
    let sample = format!("kind = \"spheres\"\nspheres = {spheres}\ndensity_kg_per_m3 = 1000.0");
    scene_of(&sample, time_step_s, rest)
}

fn scene_of(sample: &str, time_step_s: f64, rest: &str) -> Result<Case, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("discs.toml");
    let text = format!(
        "name = \"discs\"\nwhy = \"\"\nsource = \"\"\nknown = \"\"\nsolve_at = 1\n\
         [sample]\n{sample}\n\
         [scene]\nlaw = \"iqs\"\ntime_step_s = {time_step_s}\n{rest}"
    );
    std::fs::write(&path, text).unwrap();
    Case::read(&path, &[]).map_err(|error| error.to_string())
}
