//! Frames for ParaView: a file of VTK polydata per kept time step, and a collection that lists their times.

use crate::terminal::{say, write_whole};
use anyhow::{Context, Result, bail};
use cases::{March, TimeStep};
use nalgebra::Vector2;
use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use vtkio::model::{Attribute, Attributes, ByteOrder, DataSet, PolyDataPiece, Version, VertexNumbers, Vtk};

/// A folder of frames, with their collection: whole at any moment, so that a program that is killed leaves what it wrote.
pub(crate) struct Frames {
    folder: PathBuf,
    name: String,
    path: PathBuf,
    collection: File,
    written: usize,
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n";
const TAIL: &str = "  </Collection>\n</VTKFile>\n";

impl Frames {
    /// In a folder that is not there, or empty.
    pub(crate) fn new(folder: &Path, name: &str) -> Result<Self> {
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
        Ok(Self { folder: folder.to_owned(), name: name.to_owned(), path, collection, written: 0 })
    }

    /// Adds the state after a time step, with the impulses `r` (N·s) that it took.
    pub(crate) fn add(&mut self, time: f64, march: &March, time_step: &TimeStep, r: &[f64]) -> Result<()> {
        let file = format!("{}-{:06}.vtp", self.name, march.time_steps());
        let mut bytes = Vec::new();
        frame(march, time_step, r).write_xml(&mut bytes).with_context(|| file.clone())?;
        write_whole(&self.folder.join(&file), &String::from_utf8(bytes)?)?;
        // In place of the closing tags, in one write with them.
        let line = format!("    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>\n{TAIL}");
        let collection = &mut self.collection;
        let end = collection.seek(SeekFrom::End(0)).with_context(|| self.path.display().to_string())?;
        let before_the_tail = SeekFrom::Start(end - TAIL.len() as u64);
        let write = collection.seek(before_the_tail).and_then(|_| collection.write_all(line.as_bytes()));
        write.with_context(|| self.path.display().to_string())?;
        self.written += 1;
        Ok(())
    }

    /// Says where they are.
    pub(crate) fn say(&self) -> Result<()> {
        say(format_args!("{}: {} frames", self.path.display(), self.written))
    }
}

/// Grains as vertices with `radius_m` and `velocity_m_per_s`; contacts as lines with `impulse_n_s` from the centre of the
/// candidate to that of the antagonist, or to the point of the wall, which has no radius.
fn frame(march: &March, time_step: &TimeStep, r: &[f64]) -> Vtk {
    let problem = &time_step.frozen.problem;
    let (mut radius, mut points, mut velocity) = (Vec::new(), Vec::new(), Vec::new());
    let add = |list: &mut Vec<f64>, v: Vector2<f64>| list.extend([v.x, v.y, 0.0]);
    for (grain_radius, place, speed) in march.grains() {
        radius.push(grain_radius);
        add(&mut points, place);
        add(&mut velocity, speed);
    }
    let grains = radius.len();
    let mut lines = Vec::new();
    for (contact, gap) in problem.contacts().iter().zip(&time_step.frozen.gap) {
        let candidate = contact.candidate as usize;
        let end = contact.antagonist.map_or(radius.len(), |j| j as usize);
        if contact.antagonist.is_none() {
            let centre = Vector2::new(points[3 * candidate], points[3 * candidate + 1]);
            add(&mut points, centre - contact.normal * (radius[candidate] + gap));
            add(&mut velocity, Vector2::zeros());
            radius.push(0.0);
        }
        lines.extend([candidate as u64, end as u64]);
    }
    // Cells are the vertices, then the lines.
    let impulses: Vec<f64> = std::iter::repeat_n(0.0, grains).chain(r.iter().copied()).collect();
    let cells = |connectivity: Vec<u64>, size: usize| {
        let offsets = (1..=connectivity.len() / size).map(|k| (k * size) as u64).collect();
        Some(VertexNumbers::XML { connectivity, offsets })
    };
    let data = Attributes {
        point: vec![
            Attribute::scalars("radius_m", 1).with_data(radius),
            Attribute::vectors("velocity_m_per_s").with_data(velocity),
        ],
        cell: vec![Attribute::scalars("impulse_n_s", 1).with_data(impulses)],
    };
    Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::inline(PolyDataPiece {
            points: points.into(),
            verts: cells((0..grains as u64).collect(), 1),
            lines: cells(lines, 2),
            data,
            ..PolyDataPiece::default()
        }),
    }
}
