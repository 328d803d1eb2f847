use super::{Placed, placed};

fn read(text: &str, in_space: bool) -> Result<Vec<[f64; 4]>, String> {
    Ok(grains(text, in_space)?.into_iter().map(|grain| grain.ball).collect())
}

fn grains(text: &str, in_space: bool) -> Result<Vec<Placed>, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grains.csv");
    std::fs::write(&file, text).unwrap();
    placed(&file, in_space)
}

#[test]
fn columns_stand_in_any_order_beside_others() {
    let discs = read("name, radius_m, y_m, x_m\n a, 0.5, 2, 1\nb,0.25,4,3\n", false).unwrap();
    assert_eq!(discs, [[1.0, 2.0, 0.0, 0.5], [3.0, 4.0, 0.0, 0.25]]);
    let spheres = read("x_m,y_m,z_m,radius_m\n1,2,3,0.5\n", true).unwrap();
    assert_eq!(spheres, [[1.0, 2.0, 3.0, 0.5]]);
}

#[test]
fn what_has_no_meaning_is_named_with_its_line() {
    let refused = |text: &str, in_space: bool| read(text, in_space).unwrap_err();
    assert!(
        refused("x_m,y_m\n1,2\n", false).contains("line 1 is \"x_m,y_m\": the column `radius_m` is missing")
    );
    assert!(refused("x_m,x_m,y_m,radius_m\n1,2,3,4\n", false).contains("the column `x_m` is there twice"));
    let word = refused("x_m,y_m,radius_m\n0,0,1\n0,high,1\n", false);
    assert!(word.contains("grains.csv: line 3: `y_m` is \"high\": a number is asked"), "{word}");
    let commas = refused("x_m,y_m,radius_m\n\"0,0\",\"0,1\",\"0,1\"\n", false);
    assert!(
        commas.contains("line 2: `x_m` is \"0,0\"") && commas.contains("decimals have points"),
        "{commas}"
    );
    assert!(refused("x_m,y_m,radius_m\n0,,1\n", false).contains("line 2: `y_m` is \"\""));
    let short = refused("x_m,y_m,radius_m\n0,0.1\n", false);
    assert!(short.contains("line 2 is \"0,0.1\": `radius_m` is missing, since it has 2 values"), "{short}");
    let none = refused("x_m,y_m,radius_m\n0,0,1\n0,4,-1\n", false);
    assert!(none.contains("line 3: [x, y, z, radius] is [0, 4, 0, -1]"), "{none}");
    let overlapping = refused("x_m,y_m,radius_m\n0,0,1\n9,9,1\n0,1.8,1\n", false);
    assert!(overlapping.contains("the grains of lines 2 and 4 overlap"), "{overlapping}");
    assert!(refused("x_m,y_m,radius_m\n", false).contains("it has no grain"));
    assert_eq!(read("x_m,y_m,radius_m\n0,0,1\n0,1.95,1\n", false).unwrap().len(), 2);
    assert!(refused("x_m,y_m,radius_m\n0,0,1\n", true).contains("needs the column `z_m`"));
    assert!(refused("x_m,y_m,z_m,radius_m\n0,0,0,1\n", false).contains("`placed-spheres`"));
    assert!(refused("x_m,y_m,radius_m\n0,0,nan\n", false).contains("NaN"));
    // As spreadsheets write them where decimals have commas.
    let sheet = refused("x_m;y_m;radius_m\n0,0;0,1;0,1\n0,25;0,1;0,1\n", false);
    assert!(
        sheet.contains("line 1 is \"x_m;y_m;radius_m\", with semicolons") && sheet.contains("0.25"),
        "{sheet}"
    );
    assert!(refused("x_m\ty_m\tradius_m\n0\t0\t1\n", false).contains("with tabs between values"));
    let decimals = refused("x_m,y_m,radius_m\n0,0,0,1,0,1\n", false);
    assert!(
        decimals.contains("line 2 is \"0,0,0,1,0,1\"") && decimals.contains("decimals have points"),
        "{decimals}"
    );
}

#[test]
fn file_that_is_no_text_in_utf_8_is_named_with_its_byte() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("grains.csv");
    std::fs::write(&file, b"x_m,y_m,radius_m,name\n0,0,1,\xe9t\xe9\n").unwrap();
    let latin = placed(&file, false).unwrap_err();
    assert!(
        latin.contains("grains.csv: it is no text in UTF-8, by the byte 0xe9 on line 2: save it"),
        "{latin}"
    );
    std::fs::write(&file, "\u{feff}x_m,y_m,radius_m\n0,0,1\n").unwrap();
    let grains = placed(&file, false).unwrap();
    assert_eq!(grains.iter().map(|grain| grain.ball).collect::<Vec<_>>(), [[0.0, 0.0, 0.0, 1.0]]);
}

#[test]
fn densities_velocities_and_spins_are_read_where_they_are_there() {
    let discs = grains(
        "x_m,y_m,radius_m,spin_rad_per_s,velocity_y_m_per_s,density_kg_per_m2\n1,2,0.5,3,-4,900\n",
        false,
    );
    let [Placed { density, motion, .. }] = discs.unwrap()[..] else { panic!("one disc") };
    assert_eq!((density, motion), (Some(900.0), [0.0, -4.0, 0.0, 0.0, 0.0, 3.0]));
    let spheres = grains("x_m,y_m,z_m,radius_m,velocity_z_m_per_s,spin_x_rad_per_s\n1,2,3,0.5,6,7\n", true);
    let [Placed { density, motion, .. }] = spheres.unwrap()[..] else { panic!("one sphere") };
    assert_eq!((density, motion), (None, [0.0, 0.0, 6.0, 7.0, 0.0, 0.0]));
    let refused = grains("x_m,y_m,radius_m,density_kg_per_m2\n1,2,0.5,-1\n", false).unwrap_err();
    assert!(refused.contains("line 2: `density_kg_per_m2` is -1"), "{refused}");
}
