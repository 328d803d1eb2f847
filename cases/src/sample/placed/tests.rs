use super::placed;

fn read(text: &str, in_space: bool) -> Result<Vec<[f64; 4]>, String> {
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
    assert!(refused("x_m,y_m\n1,2\n", false).contains("missing field `radius_m`"));
    let word = refused("x_m,y_m,radius_m\n0,0,1\n0,high,1\n", false);
    assert!(word.contains("grains.csv: ") && word.contains("line: 3"), "{word}");
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
    assert!(decimals.contains("line: 2") && decimals.contains("points in decimals"), "{decimals}");
}
