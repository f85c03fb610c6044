//! `frames/*.vtu` and `run.pvd`: the deformed tetrahedra over time, for ParaView.
//!
//! One unstructured grid a frame holds all bodies. At points: `reference_position` (m),
//! `displacement` from it (m), `velocity` (m/s). At cells: `cauchy_stress` (Pa, nine components
//! xx xy xz yx yy yz zx zy zz, tension positive), `principal_stresses` (Pa, largest first),
//! `body_id` (position of the body in the scene), `fragment_id` (counted from 0 in each body), `failure_index` (0
//! unstressed, 1 fails; 0 for what cannot break), `failure_time_s` (when the element first took part in a crack; -1:
//! never. Parts of an element that was cut have its time), `crack_faces` (how many of its faces lie on a crack).
//! Arrays are binary, 64-bit floats.

use super::{ExportError, create_folder, write_whole};
use crate::sim::{ElementStress, NEVER_FAILED_S, World};
use glam::DVec3;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version,
    VertexNumbers, Vtk,
};

/// Folder of the frames, beside the collection.
pub const FRAME_FOLDER: &str = "frames";
/// Name of the collection that lists the frames with their times.
pub const COLLECTION_FILE: &str = "run.pvd";
/// Until this many frames the collection is rewritten with each one, then ever more rarely.
const FRAMES_LISTED_AT_ONCE: usize = 100;

/// Writes a series of frames and keeps the collection that lists them.
#[derive(Debug)]
pub struct VtuSeries {
    folder: PathBuf,
    times_s: Vec<f64>,
    listed: usize,
}

impl VtuSeries {
    /// Starts a series in an existing folder and writes an empty collection.
    ///
    /// # Errors
    /// [`ExportError::Io`] when the folder of the frames or the collection cannot be written.
    pub fn create(folder: &Path) -> Result<Self, ExportError> {
        create_folder(&folder.join(FRAME_FOLDER))?;
        let mut series = Self { folder: folder.to_path_buf(), times_s: Vec::new(), listed: 0 };
        series.close()?;
        Ok(series)
    }

    /// Writes the world as the next frame.
    ///
    /// # Errors
    /// [`ExportError`] when the frame or the collection cannot be written.
    pub fn write(&mut self, world: &World) -> Result<(), ExportError> {
        let path = self.folder.join(frame_file(self.times_s.len()));
        write_whole(&path, &encode(world, &path)?)?;
        self.times_s.push(world.time_s());
        // Rewriting a long list for each frame would cost time quadratic in the frames.
        let unlisted = self.times_s.len() - self.listed;
        if unlisted * FRAMES_LISTED_AT_ONCE >= self.times_s.len() {
            self.close()?;
        }
        Ok(())
    }

    /// Brings the collection up to date with all frames written.
    ///
    /// # Errors
    /// [`ExportError::Io`] when the collection cannot be written.
    pub fn close(&mut self) -> Result<(), ExportError> {
        let collection = collection_xml(&self.times_s);
        write_whole(&self.folder.join(COLLECTION_FILE), collection.as_bytes())?;
        self.listed = self.times_s.len();
        Ok(())
    }

    /// Frames written so far.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.times_s.len()
    }
}

/// Path of a frame relative to the collection; with `/` on every system, as ParaView wants it.
fn frame_file(index: usize) -> String {
    format!("{FRAME_FOLDER}/frame-{index:06}.vtu")
}

fn collection_xml(times_s: &[f64]) -> String {
    let mut xml = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (index, time_s) in times_s.iter().enumerate() {
        let file = frame_file(index);
        writeln!(xml, "<DataSet timestep=\"{time_s:?}\" group=\"\" part=\"0\" file=\"{file}\"/>")
            .expect("writing to a String cannot fail");
    }
    xml.push_str("</Collection>\n</VTKFile>\n");
    xml
}

fn encode(world: &World, path: &Path) -> Result<Vec<u8>, ExportError> {
    let file = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        file_path: None,
        data: DataSet::inline(Grid::of(world).into_piece()),
    };
    let mut bytes = b"<?xml version=\"1.0\"?>\n".to_vec();
    file.write_xml(&mut bytes)
        .map_err(|error| ExportError::Encode { path: path.to_path_buf(), reason: error.to_string() })?;
    Ok(bytes)
}

/// All bodies in one list of points and one of tetrahedra.
#[derive(Default)]
struct Grid {
    points_m: Vec<f64>,
    reference_m: Vec<f64>,
    displacement_m: Vec<f64>,
    velocity_m_s: Vec<f64>,
    connectivity: Vec<u64>,
    cauchy_pa: Vec<f64>,
    principal_pa: Vec<f64>,
    body_id: Vec<u32>,
    fragment_id: Vec<u32>,
    failure_index: Vec<f64>,
    failure_time_s: Vec<f64>,
    crack_faces: Vec<u32>,
}

impl Grid {
    fn of(world: &World) -> Self {
        let mut grid = Self::default();
        for body in (0..world.body_count()).filter(|body| !world.is_removed(*body)) {
            grid.add_cells(world, body);
            grid.add_points(world, body);
        }
        grid
    }

    fn add_points(&mut self, world: &World, body: usize) {
        let positions_m = world.positions_m(body);
        let reference_m = world.reference_positions_m(body);
        let displacements_m = positions_m.iter().zip(reference_m).map(|(&x, &r)| x - r);
        extend(&mut self.displacement_m, displacements_m);
        extend(&mut self.points_m, positions_m.iter().copied());
        extend(&mut self.reference_m, reference_m.iter().copied());
        extend(&mut self.velocity_m_s, world.velocities_m_s(body).iter().copied());
    }

    /// Adds the tetrahedra of a body whose points are added next.
    fn add_cells(&mut self, world: &World, body: usize) {
        let first_point = (self.points_m.len() / 3) as u64;
        let tets = world.tets(body);
        self.connectivity.extend(tets.iter().flatten().map(|&node| first_point + u64::from(node)));
        for ElementStress { cauchy_pa, principal_pa } in world.element_stresses(body) {
            extend(&mut self.principal_pa, [principal_pa]);
            // Row by row; the tensor is symmetric up to round-off.
            self.cauchy_pa.extend(cauchy_pa.transpose().to_cols_array());
        }
        let id = u32::try_from(body).unwrap_or(u32::MAX);
        self.body_id.extend(std::iter::repeat_n(id, tets.len()));
        self.fragment_id.extend(world.fragment_of_element(body));
        self.fragment_id.resize(self.body_id.len(), 0);
        self.failure_index.extend(world.failure_indices(body));
        self.failure_index.resize(self.body_id.len(), 0.0);
        self.failure_time_s.extend(world.failure_times_s(body));
        self.failure_time_s.resize(self.body_id.len(), NEVER_FAILED_S);
        let first_cell = self.crack_faces.len();
        self.crack_faces.resize(self.body_id.len(), 0);
        for face in world.crack_faces(body) {
            self.crack_faces[first_cell + face.element as usize] += 1;
        }
    }

    fn into_piece(self) -> UnstructuredGridPiece {
        let cells = self.body_id.len();
        let attributes = Attributes {
            point: vec![
                Attribute::generic("reference_position", 3).with_data(self.reference_m),
                Attribute::generic("displacement", 3).with_data(self.displacement_m),
                Attribute::generic("velocity", 3).with_data(self.velocity_m_s),
            ],
            cell: vec![
                Attribute::generic("cauchy_stress", 9).with_data(self.cauchy_pa),
                Attribute::generic("principal_stresses", 3).with_data(self.principal_pa),
                Attribute::generic("body_id", 1).with_data(self.body_id),
                Attribute::generic("fragment_id", 1).with_data(self.fragment_id),
                Attribute::generic("failure_index", 1).with_data(self.failure_index),
                Attribute::generic("failure_time_s", 1).with_data(self.failure_time_s),
                Attribute::generic("crack_faces", 1).with_data(self.crack_faces),
            ],
        };
        UnstructuredGridPiece {
            points: self.points_m.into(),
            cells: Cells {
                cell_verts: VertexNumbers::XML {
                    connectivity: self.connectivity,
                    offsets: (1..=cells as u64).map(|cell| 4 * cell).collect(),
                },
                types: vec![CellType::Tetra; cells],
            },
            data: attributes,
        }
    }
}

fn extend(numbers: &mut Vec<f64>, vectors: impl IntoIterator<Item = DVec3>) {
    numbers.extend(vectors.into_iter().flat_map(|v| v.to_array()));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TetMesh;
    use crate::sim::{BodySetup, Material, WorldSetup};

    fn body(name: &str, shift_m: f64) -> BodySetup {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let nodes_m = corners.map(|x| x + DVec3::X * shift_m).to_vec();
        let mesh = TetMesh::with_one_region(nodes_m, vec![[0, 1, 2, 3]]);
        let steel = Material::elastic("steel", 7800.0, 2e11, 0.3);
        BodySetup { velocity_m_s: DVec3::Y, ..BodySetup::at_rest(name, mesh, steel) }
    }

    fn world() -> World {
        World::new(WorldSetup { bodies: vec![body("a", 0.0), body("b", 5.0)], ..WorldSetup::default() })
            .unwrap()
    }

    fn array(attributes: &[Attribute], name: &str) -> Vec<f64> {
        let found = attributes.iter().find(|a| a.name() == name);
        let Some(Attribute::DataArray(array)) = found else {
            panic!("no array {name}");
        };
        array.data.cast_into::<f64>().unwrap()
    }

    #[test]
    fn a_frame_reads_back_with_bodies_numbered_apart() {
        let folder = tempfile::tempdir().unwrap();
        let mut series = VtuSeries::create(folder.path()).unwrap();
        series.write(&world()).unwrap();
        let file = Vtk::import(folder.path().join("frames/frame-000000.vtu")).unwrap();
        let piece = UnstructuredGridPiece::try_from(file.data).unwrap();
        assert_eq!(piece.num_points(), 8);
        let points = piece.points.cast_into::<f64>().unwrap();
        assert_eq!(points[12..15], [5.0, 0.0, 0.0]);
        let (connectivity, offsets) = piece.cells.cell_verts.into_xml();
        assert_eq!(connectivity, [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(offsets, [4, 8]);
        assert_eq!(array(&piece.data.cell, "body_id"), [0.0, 1.0]);
        assert_eq!(array(&piece.data.point, "reference_position"), points);
        assert_eq!(array(&piece.data.cell, "failure_time_s"), [-1.0; 2]);
        assert_eq!(array(&piece.data.cell, "crack_faces"), [0.0; 2]);
        assert_eq!(array(&piece.data.cell, "cauchy_stress").len(), 18);
        assert_eq!(array(&piece.data.cell, "principal_stresses").len(), 6);
        assert_eq!(array(&piece.data.point, "velocity").len(), 24);
        assert_eq!(array(&piece.data.point, "displacement"), [0.0; 24]);
    }

    #[test]
    fn the_collection_lists_every_frame_after_closing_and_nearly_all_before() {
        let folder = tempfile::tempdir().unwrap();
        let mut series = VtuSeries::create(folder.path()).unwrap();
        let world = world();
        let listed = || {
            let text = std::fs::read_to_string(folder.path().join(COLLECTION_FILE)).unwrap();
            assert!(text.ends_with("</VTKFile>\n"));
            text.matches("<DataSet ").count()
        };
        assert_eq!(listed(), 0);
        for frames in 1..=230 {
            series.write(&world).unwrap();
            assert!(listed() * 100 >= (frames - 1) * 98, "{frames}");
        }
        series.close().unwrap();
        assert_eq!(listed(), 230);
    }
}
