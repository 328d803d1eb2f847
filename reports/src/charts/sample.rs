//! A sample under a partition: discs by subdomain, boundary grains, walls, and chains of impulses.

mod view;

use rayon::prelude::*;

use crate::draw::{
    BOUNDARY_GRAIN, CHAIN, Canvas, GRAIN, HPos, IDLE, LEADING, MARGIN, Pen, SUBDOMAINS, Sign, Signs, TEXT,
    TICK_TEXT, VPos, WALL, WHITE, subdomain_fill, svg, text_width,
};
use crate::read::{Problems, Scene, count, counted, ends, file_name, impulse, number, walls};
use crate::text::Part;
use view::View;

/// Thinner lines than this (mm) do not print.
const THINNEST_CHAIN: f64 = 0.04;

/// `sample-<problem>-<partition>` for each problem and partition of the tables.
pub(crate) fn parts(study: &Problems) -> Vec<Part> {
    let figure = |((problem, partition), scene): (&(String, String), &Scene)| {
        let name = format!("sample-{}-{}", file_name(problem), file_name(partition));
        Part::figure(
            name,
            drawn(&format!("{problem}, {partition}"), partition, scene, "the reference solution"),
        )
    };
    study.scenes.par_iter().map(figure).collect()
}

/// Draws a scene of one subdomain, under a title, with impulses `of` a solution.
pub(crate) fn draw(title: &str, scene: &Scene, of: &str) -> String {
    drawn(title, "", scene, of)
}

/// The scene, its scales, the key of its colours, and its counts in words.
fn drawn(title: &str, partition: &str, scene: &Scene, of: &str) -> String {
    let view = View::of(scene);
    let inside = view.width - 2.0 * MARGIN;
    let key = key(scene, inside);
    let mut lines = wrapped(title, inside);
    lines.extend(wrapped(&caption(scene, &view, of), inside));
    let scales = MARGIN + view.height + 0.8 * LEADING;
    let key_top = scales + 0.8 * LEADING;
    let text_top = key_top + key.height() + 0.3 * LEADING;
    let height = text_top + LEADING * lines.len() as f64 + MARGIN;
    svg((view.width, height.ceil()), |canvas| {
        draw_scene(canvas, &view, partition, scene);
        view.draw_scales(canvas, scales);
        key.draw(canvas, (MARGIN, key_top));
        for (i, line) in lines.iter().enumerate() {
            canvas.text(line, (MARGIN, text_top + LEADING * i as f64), TEXT, (HPos::Left, VPos::Top));
        }
    })
}

/// The discs that need a word; subdomains have their names in the scene.
fn key(scene: &Scene, width: f64) -> Signs {
    let boundary = scene.grains.iter().any(|grain| grain.multiplicity > 1);
    let idle = scene.grains.iter().any(|grain| grain.subdomain.is_none());
    let entries = [
        boundary.then(|| (Sign::Grain(WHITE, BOUNDARY_GRAIN), "boundary grain".to_owned())),
        idle.then(|| (Sign::Grain(IDLE, GRAIN), "no contact".to_owned())),
    ];
    Signs::new(entries.into_iter().flatten().collect(), width)
}

fn draw_scene(canvas: &Canvas, view: &View, partition: &str, scene: &Scene) {
    // Boundary grains last, so that no neighbour covers their outline.
    let (boundary, inner): (Vec<_>, Vec<_>) = scene.grains.iter().partition(|grain| grain.multiplicity > 1);
    for grain in inner.into_iter().chain(boundary) {
        let fill = grain.subdomain.map_or(IDLE, |subdomain| SUBDOMAINS[subdomain_fill(partition, subdomain)]);
        let outline = if grain.multiplicity > 1 { BOUNDARY_GRAIN } else { GRAIN };
        canvas.disc(view.place((grain.x_m, grain.y_m)), grain.radius_m * view.scale, fill, Some(outline));
    }
    for (from, to) in walls(&scene.contacts) {
        canvas.line(&[view.place(from), view.place(to)], WALL);
    }
    for contact in &scene.contacts {
        let width = impulse(contact).map_or(0.0, |impulse| view.chain_width(impulse));
        if width >= THINNEST_CHAIN {
            let (from, to) = ends(contact);
            canvas.line(&[view.place(from), view.place(to)], Pen::solid(CHAIN, width));
        }
    }
    draw_names(canvas, view, scene);
}

/// Each subdomain's name amid its contacts: in grey, eight fills are not told apart by a key.
fn draw_names(canvas: &Canvas, view: &View, scene: &Scene) {
    const RADIUS: f64 = 2.2;
    let subdomains = scene.subdomains();
    if subdomains.len() < 2 {
        return;
    }
    for subdomain in subdomains {
        let contacts = scene.contacts.iter().filter(|contact| contact.subdomain == subdomain);
        let places = contacts.map(|contact| view.place(ends(contact).0));
        let (count, sum) =
            places.fold((0.0, (0.0, 0.0)), |(n, sum), (x, y)| (n + 1.0, (sum.0 + x, sum.1 + y)));
        let middle = (sum.0 / count, sum.1 / count);
        canvas.disc(middle, RADIUS, WHITE, Some(GRAIN));
        canvas.text(&format!("E{subdomain}"), middle, TICK_TEXT, (HPos::Center, VPos::Center));
    }
}

/// The counts, and what the lines mean.
fn caption(scene: &Scene, view: &View, of: &str) -> String {
    let walls = scene.contacts.iter().filter(|contact| contact.wall).count();
    let boundary = scene.grains.iter().filter(|grain| grain.multiplicity > 1).count();
    let counts = format!(
        "{}, {}, {} of them with walls, {}, {}.",
        counted(scene.grains.len(), "grain"),
        counted(scene.contacts.len(), "contact"),
        count(walls),
        counted(scene.subdomains().len(), "subdomain"),
        counted(boundary, "boundary grain"),
    );
    if view.greatest > 0.0 {
        let share = number(100.0 * THINNEST_CHAIN / view.widest, 1);
        format!("{counts} Lines: impulses of {of}; below {share}\u{a0}% of the greatest not drawn.")
    } else {
        format!("{counts} No impulse is known.")
    }
}

/// Breaks a text between words at a width (mm).
fn wrapped(text: &str, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // Not at the narrow spaces inside numbers.
    for word in text.split(' ') {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match (longer, lines.last_mut()) {
            (Some(longer), Some(line)) if text_width(&longer, TEXT) <= width => *line = longer,
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}
