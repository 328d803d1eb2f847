//! Frames for ParaView: at each kept time the grains, the contacts and the walls as files of an unstructured grid, and a
//! collection that lists them.

use crate::run::rows::subdomain_of_grains;
use crate::terminal::{say, write_whole};
use anyhow::{Context, Result, bail};
use cases::{Homogenised, Side};
use lineup::{OneMarch, OneProblem};
use partition::{Grid, Partition, Scheme};
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version,
    VertexNumbers, Vtk,
};

/// A folder of frames, with their collection: whole at any moment, so that a program that is killed leaves what it wrote.
pub(crate) struct Frames {
    folder: PathBuf,
    name: String,
    path: PathBuf,
    collection: File,
    written: usize,
    /// Grid and rule of the method's partition, if it has one.
    partition: Option<(Grid, Scheme)>,
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
const TAIL: &str = "  </Collection>\n</VTKFile>\n";

impl Frames {
    /// Begins a collection in a folder that is not there, or empty.
    pub(crate) fn new(folder: &Path, name: &str, partition: Option<(Grid, Scheme)>) -> Result<Self> {
        if folder.is_file() || folder.read_dir().is_ok_and(|mut entries| entries.next().is_some()) {
            bail!("--vtk {}: it exists, and is no empty folder: give another one", folder.display());
        }
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        let path = folder.join(format!("{name}.pvd"));
        let begin = || -> io::Result<File> {
            let mut file = File::create_new(&path)?;
            file.write_all(format!("{HEAD}{TAIL}").as_bytes())?;
            Ok(file)
        };
        let collection = begin().with_context(|| path.display().to_string())?;
        let name = name.to_owned();
        Ok(Self { folder: folder.to_owned(), name, path, collection, written: 0, partition })
    }

    /// Adds the state of a march: after a time step, with the problem and the impulses (N·s) that it took.
    pub(crate) fn add(&mut self, march: &dyn OneMarch, solved: Solved) -> Result<()> {
        let time = march.time();
        let split = solved
            .zip(self.partition)
            .and_then(|((problem, _), (grid, scheme))| problem.cut(grid, scheme).ok());
        let split = split.map(|(partition, decomposition)| (partition, decomposition.multiplicity));
        let parts = [
            ("grains", grains(march, solved, split.as_ref())),
            ("contacts", contacts(march, solved, split.as_ref())),
            ("walls", walls(march)),
        ];
        let mut lines = String::new();
        // A grid without points is none to its readers: where nothing touches, there is no file of contacts.
        let some = parts.into_iter().enumerate().filter(|(_, (_, grid))| !grid.points.is_empty());
        for (part, (name, grid)) in some {
            let file = format!("{}-{name}-{:06}.vtu", self.name, march.time_steps());
            let mut bytes = Vec::new();
            grid.into_vtk().write_xml(&mut bytes).with_context(|| file.clone())?;
            write_whole(&self.folder.join(&file), signed(&String::from_utf8(bytes)?))?;
            lines.extend([format!(
                "    <DataSet timestep=\"{time}\" part=\"{part}\" name=\"{name}\" file=\"{file}\"/>\n"
            )]);
        }
        // In place of the closing tags, in one write with them.
        lines += TAIL;
        let collection = &mut self.collection;
        let end = collection.seek(SeekFrom::End(0)).with_context(|| self.path.display().to_string())?;
        let before_the_tail = SeekFrom::Start(end - TAIL.len() as u64);
        let write = collection.seek(before_the_tail).and_then(|_| collection.write_all(lines.as_bytes()));
        write.with_context(|| self.path.display().to_string())?;
        self.written += 1;
        Ok(())
    }

    /// Says where they are.
    pub(crate) fn say(&self) -> Result<()> {
        say(format_args!("{}: {} frames", self.path.display(), self.written))
    }
}

/// Returns the text of a frame with the type of numbers of points that VTK itself writes, and meshio alone reads. They are far below 2⁶³, so
/// their bytes are the same.
fn signed(frame: &str) -> String {
    frame.replace(" type=\"UInt64\"", " type=\"Int64\"")
}

/// Shape of the cells.
#[derive(Clone, Copy, Default)]
enum Shape {
    #[default]
    Point,
    Line,
    Face,
}

/// Points, lines of two points each or faces of four, with values.
#[derive(Default)]
struct Elements {
    points: Vec<f64>,
    shape: Shape,
    /// Values of each cell.
    values: Vec<Attribute>,
}

impl Elements {
    fn add(&mut self, place: [f64; 3]) {
        self.points.extend(place);
    }

    fn numbers(&mut self, name: &str, values: Vec<f64>) {
        self.values.push(Attribute::scalars(name, 1).with_data(values));
    }

    /// Adds an index for each cell: −1 where there is none.
    fn indices(&mut self, name: &str, values: impl IntoIterator<Item = Option<u32>>) {
        let values: Vec<i64> = values.into_iter().map(|value| value.map_or(-1, i64::from)).collect();
        self.values.push(Attribute::scalars(name, 1).with_data(values));
    }

    fn vectors(&mut self, name: &str, values: impl Iterator<Item = [f64; 3]>) {
        let values: Vec<f64> = values.flatten().collect();
        self.values.push(Attribute::vectors(name).with_data(values));
    }

    /// The values of points are theirs, so that glyphs take them; those of lines and faces belong to their cells.
    fn into_vtk(self) -> Vtk {
        let (size, kind) = match self.shape {
            Shape::Point => (1, CellType::Vertex),
            Shape::Line => (2, CellType::Line),
            Shape::Face => (4, CellType::Quad),
        };
        let points = self.points.len() as u64 / 3;
        let cells = points / size;
        let offsets = (1..=cells).map(|k| k * size).collect();
        let verts = VertexNumbers::XML { connectivity: (0..points).collect(), offsets };
        let (point, cell) = if size > 1 { (Vec::new(), self.values) } else { (self.values, Vec::new()) };
        Vtk {
            version: Version::new_xml(1, 0),
            title: String::new(),
            byte_order: ByteOrder::LittleEndian,
            file_path: None,
            data: DataSet::inline(UnstructuredGridPiece {
                points: self.points.into(),
                cells: Cells { cell_verts: verts, types: vec![kind; cells as usize] },
                data: Attributes { point, cell },
            }),
        }
    }
}

/// Problem of a solved time step, if there is one, and its impulses (N·s).
type Solved<'t> = Option<(&'t dyn OneProblem, &'t [f64])>;

/// Partition of its contacts, if the method has one, and the number of copies of each grain.
type Split = (Partition, Vec<u32>);

/// A vertex for each grain.
fn grains(march: &dyn OneMarch, solved: Solved, split: Option<&Split>) -> Elements {
    let mut elements = Elements::default();
    let bodies = march.bodies();
    for body in &bodies {
        elements.add(body.place);
    }
    let count = bodies.len();
    // Of a method without subdomains all is in one; before the first contacts, and without contact, a grain is in none.
    let (subdomain, copies) = match (solved, split) {
        (Some((problem, _)), Some((partition, copies))) => {
            (subdomain_of_grains(count, &problem.touching(), partition), copies.clone())
        }
        (Some(_), None) => (vec![Some(0); count], vec![1; count]),
        (None, _) => (vec![None; count], vec![1; count]),
    };
    elements.indices("grain", (0..count as u32).map(Some));
    elements.numbers("radius_m", bodies.iter().map(|body| body.radius).collect());
    elements.numbers("mass_kg", bodies.iter().map(|body| body.mass).collect());
    elements.vectors("velocity_m_per_s", bodies.iter().map(|body| body.velocity));
    let spins = bodies.iter().flat_map(|body| &body.spin).copied().collect::<Vec<_>>();
    match spins.len() / count {
        0 => {}
        1 => elements.numbers("spin_rad_per_s", spins),
        _ => elements.values.push(Attribute::vectors("spin_rad_per_s").with_data(spins)),
    }
    let material = solved.map_or_else(Vec::new, |(problem, r)| {
        let one = || (vec![0; problem.facts().contacts], 1);
        let (list, count) = split.map_or_else(one, |(p, _)| (p.subdomain.clone(), p.count as usize));
        problem.homogenised(march.grain_count(), (&list, count), r)
    });
    let of_material = |value: &dyn Fn(&Homogenised) -> f64| {
        subdomain.iter().map(|e| e.and_then(|e| material.get(e as usize)).map_or(0.0, value)).collect()
    };
    let dimensions = march.dimensions();
    let pressure = if dimensions > 2 { "n_per_m2" } else { "n_per_m" };
    let pressure = format!("subdomain_pressure_{pressure}");
    elements.numbers(&pressure, of_material(&|one| one.pressure(dimensions)));
    elements.numbers("subdomain_coordination", of_material(&|one| one.coordination));
    elements.indices("subdomain", subdomain);
    elements.indices("multiplicity", copies.into_iter().map(|copies| Some(copies.max(1))));
    elements
}

/// A line for each contact, from the centre of the candidate to that of the antagonist, or to the point of the wall.
fn contacts(march: &dyn OneMarch, solved: Solved, split: Option<&Split>) -> Elements {
    let mut elements = Elements { shape: Shape::Line, ..Elements::default() };
    let Some((problem, r)) = solved else { return elements };
    let (list, bodies) = (problem.touching(), march.bodies());
    for contact in &list {
        let body = &bodies[contact.candidate as usize];
        let reach = body.radius + contact.gap;
        let wall = || [0, 1, 2].map(|k| body.place[k] - contact.normal[k] * reach);
        elements.add(body.place);
        elements.add(contact.antagonist.and_then(|j| march.beside(body.place, j)).unwrap_or_else(wall));
    }
    let subdomain = split.map_or_else(|| vec![0; list.len()], |(split, _)| split.subdomain.clone());
    let antagonist = list.iter().map(|contact| contact.antagonist);
    elements.indices("contact", (0..list.len() as u32).map(Some));
    elements.indices("candidate", list.iter().map(|contact| Some(contact.candidate)));
    elements.indices("antagonist", antagonist.clone());
    elements.indices("wall", antagonist.map(|j| Some(u32::from(j.is_none()))));
    let of_contact = problem.facts().of_contact;
    elements.numbers("impulse_n_s", r.iter().step_by(of_contact).copied().collect());
    if let Some((tangential, statuses)) = problem.tangential(r).zip(problem.statuses(r)) {
        elements.numbers("tangential_impulse_n_s", tangential);
        elements.indices("status", statuses.into_iter().map(|status| Some(status.into())));
    }
    elements.numbers("gap_m", list.iter().map(|contact| contact.gap).collect());
    elements.vectors("normal", list.iter().map(|contact| contact.normal));
    elements.indices("subdomain", subdomain.into_iter().map(Some));
    elements
}

/// A line for each wall, in 3D a face.
fn walls(march: &dyn OneMarch) -> Elements {
    let shape = if march.dimensions() > 2 { Shape::Face } else { Shape::Line };
    let mut elements = Elements { shape, ..Elements::default() };
    let walls = march.walls();
    walls.iter().flat_map(|(_, ends)| ends).for_each(|end| elements.add(*end));
    let number = |side: &Side| match side {
        Side::Floor => Some(0),
        Side::Left => Some(1),
        Side::Right => Some(2),
        Side::Drum => Some(3),
        Side::Bump(_) => Some(4),
        Side::Back => Some(5),
        Side::Front => Some(6),
        Side::Lid(..) => Some(7),
        Side::Segment(_) => Some(8),
        Side::Driven(..) => Some(9),
        Side::Grain(_) | Side::Guide(_) => None,
    };
    elements.indices("wall", walls.iter().map(|(side, _)| number(side)));
    elements
}
