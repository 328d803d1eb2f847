use super::*;

#[test]
fn contacts_with_one_wall_are_one_line_and_another_wall_is_another() {
    let contact = |(x0_m, y0_m), (x1_m, y1_m)| ContactRow {
        x0_m,
        y0_m,
        x1_m,
        y1_m,
        wall: true,
        ..ContactRow::default()
    };
    let contacts = [
        contact((0.0, 1.0), (0.0, 0.0)),
        contact((5.0, 2.0), (5.0, 0.0)),
        contact((1.0, 3.0), (-1.0, 3.0)),
        ContactRow { wall: false, ..contact((9.0, 9.0), (8.0, 8.0)) },
    ];
    let mut ends: Vec<Wall> = walls(&contacts);
    for (a, b) in &mut ends {
        if (a.0, a.1) > (b.0, b.1) {
            std::mem::swap(a, b);
        }
    }
    assert_eq!(ends, [((-0.5, 0.0), (6.0, 0.0)), ((-1.0, 2.0), (-1.0, 4.0))]);
    assert!(walls(&[contact((0.0, 0.0), (0.0, 0.0))]).is_empty());
}
