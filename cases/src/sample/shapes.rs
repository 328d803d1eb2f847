//! Grains placed by a formula: the column, the crystals, the zigzag, the rollers. Each is [x, y, z, radius] (m).

use contact::shown;

/// A column of equal discs on the floor.
pub(crate) fn column(grains: u32, radius: f64) -> Vec<[f64; 4]> {
    (0..grains).map(|k| [0.0, (2.0 * f64::from(k) + 1.0) * radius, 0.0, radius]).collect()
}

/// Rows of `columns` and `columns` − 1 discs in turn, neighbours closer than touching by `overlap` diameters.
pub(crate) fn triangular(columns: u32, rows: u32, radius: f64, overlap: f64) -> Vec<[f64; 4]> {
    // Half the distance of neighbours; those on the floor and at the left wall touch these.
    let half = radius * (1.0 - overlap);
    let edge = radius - half;
    let mut discs = Vec::new();
    for row in 0..rows {
        let odd = row % 2;
        for column in 0..columns.saturating_sub(odd) {
            let x = edge + (2.0 * f64::from(column) + 1.0 + f64::from(odd)) * half;
            let y = edge + half * (1.0 + 3.0_f64.sqrt() * f64::from(row));
            discs.push([x, y, 0.0, radius]);
        }
    }
    discs
}

/// Discs from wall to wall, low and high in turn, each touching the next.
pub(crate) fn zigzag(grains: u32, radius: f64, width: f64) -> Result<Vec<[f64; 4]>, String> {
    // Links of length 2R, of which `along` is horizontal. Below R, a disc would touch the next but one.
    let along = (width - 2.0 * radius) / f64::from(grains.max(2) - 1);
    let rise = 4.0 * radius * radius - along * along;
    if !(along >= radius && rise >= 0.0) {
        let (least, most) = ((f64::from(grains) + 1.0) * radius, 2.0 * f64::from(grains) * radius);
        return Err(format!(
            "`scene.box.width_m` is {}: {grains} discs in a zigzag need between {} and {}",
            shown(width),
            shown(least),
            shown(most)
        ));
    }
    let height = |k: u32| radius + f64::from(k % 2) * rise.sqrt();
    let x = |k: u32| radius + f64::from(k) * along;
    Ok((0..grains).map(|k| [x(k), height(k), 0.0, radius]).collect())
}

/// Discs on the floor that all touch a disc of radius `top`, the last, and stand apart.
pub(crate) fn rollers(rollers: u32, radius: f64, top: f64) -> Result<Vec<[f64; 4]>, String> {
    // A circle of radius r at x touches the floor and the top disc: x² + (R + 2r₀ − r)² = (R + r)².
    let touching = |x: f64| radius + x * x / (4.0 * (top + radius));
    // From the middle outwards, half a radius and more between two of them.
    let mut right = vec![if rollers % 2 == 1 { 0.0 } else { 1.25 * radius }];
    while right.len() < rollers.div_ceil(2) as usize {
        let x = right[right.len() - 1];
        right.push(x + 2.5 * touching(x));
    }
    let apart = |x: &[f64]| x[1] - x[0] > touching(x[0]) + touching(x[1]);
    if let Some(&[_, x]) = right.windows(2).find(|pair| !apart(pair)) {
        return Err(format!(
            "`sample.top_radius_m` is {}: it is too small for {rollers} rollers, which overlap at {} m",
            shown(top),
            shown(x)
        ));
    }
    let left = right.iter().rev().filter(|x| **x > 0.0).map(|x| -x);
    let floor = left.chain(right.iter().copied()).map(|x| [x, touching(x), 0.0, touching(x)]);
    Ok(floor.chain([[0.0, top + 2.0 * radius, 0.0, top]]).collect())
}

/// Checks that a crystal of spheres fits between the walls of a box of this width and depth (m), up to round-off.
pub(crate) fn check_room(
    [columns, _, deep]: [u32; 3],
    radius: f64,
    size: [Option<f64>; 2],
) -> Result<(), String> {
    for ((key, count), length) in [("width_m", columns), ("depth_m", deep)].into_iter().zip(size) {
        let needed = 2.0 * radius * f64::from(count);
        if let Some(length) = length.filter(|length| *length < needed * (1.0 - 1e-9)) {
            return Err(format!(
                "`scene.box.{key}` is {}: {count} spheres of `sample.radius_m` {} side by side need {}",
                shown(length),
                shown(radius),
                shown(needed)
            ));
        }
    }
    Ok(())
}

/// Spheres each right above another.
pub(crate) fn simple_cubic([columns, rows, layers]: [u32; 3], radius: f64) -> Vec<[f64; 4]> {
    let at = |k: u32| (2.0 * f64::from(k) + 1.0) * radius;
    let rows = (0..rows).flat_map(|y| (0..layers).map(move |z| (y, z)));
    rows.flat_map(|(y, z)| (0..columns).map(move |x| [at(x), at(y), at(z), radius])).collect()
}

/// Square layers of spheres, each in the hollows of the one below: every other has one sphere less along x and along z.
pub(crate) fn face_centred([columns, layers, deep]: [u32; 3], radius: f64) -> Vec<[f64; 4]> {
    let mut spheres = Vec::new();
    for layer in 0..layers {
        let odd = layer % 2;
        let at = |k: u32| (2.0 * f64::from(k) + 1.0 + f64::from(odd)) * radius;
        let y = radius * (1.0 + 2.0_f64.sqrt() * f64::from(layer));
        for z in 0..deep.saturating_sub(odd) {
            spheres.extend((0..columns.saturating_sub(odd)).map(|x| [at(x), y, at(z), radius]));
        }
    }
    spheres
}
