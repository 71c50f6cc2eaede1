//! Worlds built by Python: shapes, materials and bodies.

use crate::cast;
use crate::data::{Body, Data, Origin};
use crate::errors::of;
use crate::lamps;
use crate::load::{self, Options};
use crate::poses;
use crate::surface::{Look, add_material, of_shape, remove_textures, surface, texels_of};
use belvedere_sensors::Pose;
use belvedere_sensors::scene::{
    Air, Environment, InstanceConfig, LightConfig, LightKind, MaterialConfig, SceneBuilder, Shape, Sky,
};
use numpy::{IntoPyArray, PyArray1, PyArray3, PyReadonlyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// Lamps in states: positions or directions, and directions of spotlights.
type PlacedLights<'py> = (Bound<'py, PyArray3<f64>>, Option<Bound<'py, PyArray3<f64>>>);

#[pyclass(frozen, module = "belvedere._native")]
pub(crate) struct World {
    data: Mutex<Arc<Data>>,
    notes: Vec<String>,
}

/// Other properties of a body: name, pose, scale, class, retro-reflection, visibility.
type Said<'py> = (String, PyReadonlyArrayDyn<'py, f64>, [f64; 3], u32, f32, u32);

impl World {
    pub(crate) fn of_data(data: Data) -> Self {
        Self { data: Mutex::new(Arc::new(data)), notes: Vec::new() }
    }

    /// Locks the world and uses it. The interpreter's lock is released first, and `act` cannot take it, since it cannot
    /// hold a `Python`: a thread that held one lock and waited for the other would stop the interpreter for ever.
    fn with<T: Send>(&self, py: Python<'_>, act: impl FnOnce(&mut Arc<Data>) -> T + Send) -> T {
        py.detach(|| act(&mut self.data.lock().unwrap_or_else(PoisonError::into_inner)))
    }

    /// Returns the current contents. Usually no other thread has locked the world, and nothing is waited for.
    pub(crate) fn data(&self, py: Python<'_>) -> Arc<Data> {
        match self.data.try_lock() {
            Ok(data) => data.clone(),
            Err(_) => self.with(py, |data| data.clone()),
        }
    }

    /// Changes the world, or a copy that replaces it while a batch still uses the original.
    fn change<T: Send>(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut Data) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        self.with(py, |data| change(Arc::make_mut(data)))
    }

    /// Adds an instance as a new body. On failure, removes the resources that were added for it.
    fn add(
        &self,
        py: Python<'_>,
        shape: impl FnOnce(&mut SceneBuilder) -> PyResult<Shape> + Send,
        look: Look<'_>,
        said: Said<'_>,
    ) -> PyResult<usize> {
        let (name, pose, scale, class, laser_retro, visibility) = said;
        let world_from_body = poses::read("pose", &pose)?.into_iter().next().unwrap_or_default();
        let surface = surface(&look)?;
        self.change(py, |data| {
            let name = new_name(data, name)?;
            let (material, config) = add_material(data, &surface)?;
            let taken = shape(&mut data.builder).and_then(|shape| {
                let instance = InstanceConfig {
                    shape,
                    world_from_instance: world_from_body,
                    scale,
                    material,
                    visibility,
                    laser_retro,
                    class,
                };
                push_instance(data, name, Origin { instance, material: config })
            });
            taken.inspect_err(|_| {
                // They were added, and no instance uses them.
                let _ = data.builder.remove_material(material);
                remove_textures(data, &config);
            })
        })
    }
}

/// Returns the name of a new body: the given one, or a free one.
fn new_name(data: &mut Data, name: String) -> PyResult<String> {
    let name = if name.is_empty() { data.free_name() } else { name };
    if data.find(&name).is_some() {
        return Err(of("name", format_args!("there is a body {name:?} already")));
    }
    Ok(name)
}

/// Adds an instance as a new body.
fn push_instance(data: &mut Data, name: String, origin: Origin) -> PyResult<usize> {
    let pose = origin.instance.world_from_instance;
    let instance = data.builder.add_instance(&origin.instance).map_err(of_shape)?;
    let parts = vec![(instance, Pose::IDENTITY)];
    Ok(data.push(Body { name, pose, parts, origin: Some(Box::new(origin)) }))
}

#[pymethods]
impl World {
    /// Creates an empty world.
    #[new]
    fn new() -> Self {
        Self::of_data(Data::default())
    }

    /// Loads a world from a file, a name or a text.
    #[staticmethod]
    fn load(
        py: Python<'_>,
        source: &str,
        package_path: Vec<PathBuf>,
        models: PathBuf,
        xacro_args: Vec<(String, String)>,
    ) -> PyResult<Self> {
        py.detach(|| {
            let (described, mut notes) = load::load(source, Options { package_path, models, xacro_args })?;
            let (data, more) = Data::of_description(described)?;
            notes.extend(more);
            Ok(Self { data: Mutex::new(Arc::new(data)), notes })
        })
    }

    /// Returns notes about ignored elements, one line each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    #[getter]
    fn bodies(&self, py: Python<'_>) -> Vec<String> {
        self.data(py).bodies.iter().map(|body| body.name.clone()).collect()
    }

    /// Returns the number of each instance's body.
    fn instance_bodies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i32>> {
        let data = self.data(py);
        let mut bodies = vec![-1; data.builder.scene().instances().len()];
        for (number, body) in data.bodies.iter().enumerate() {
            for (instance, _) in &body.parts {
                bodies[instance.0 as usize] = number as i32;
            }
        }
        PyArray1::from_vec(py, bodies)
    }

    /// Returns a copy of the world, which does not change with the original.
    fn snapshot(&self, py: Python<'_>) -> Self {
        Self { data: Mutex::new(self.data(py)), notes: self.notes.clone() }
    }

    /// Returns position or direction of each lamp, its colour, and whether it has a direction.
    fn lights(&self, py: Python<'_>) -> Vec<([f64; 3], [f32; 3], bool)> {
        let data = self.data(py);
        let lamps = data.builder.scene().lights().iter();
        let facts = lamps.map(|lamp| (lamp.vector_and_diffuse(), lamp.position().is_none()));
        facts.map(|((vector, colour), is_way)| (vector, colour, is_way)).collect()
    }

    /// Returns the lamps in states of MuJoCo: position of each, or direction of a directional one, (N, lamps, 3), and
    /// directions of spotlights, (N, lamps, 3), if the states have them.
    fn placed_lights<'py>(
        &self,
        py: Python<'py>,
        lights: Vec<usize>,
        xpos: Option<PyReadonlyArrayDyn<'_, f64>>,
        xdir: Option<PyReadonlyArrayDyn<'_, f64>>,
        camera: Option<(usize, PyReadonlyArrayDyn<'_, f64>, usize)>,
        states: usize,
    ) -> PyResult<PlacedLights<'py>> {
        let (vectors, spots) = lamps::place(&self.data(py), &lights, [xpos, xdir], camera, states)?;
        Ok((vectors.into_pyarray(py), spots.map(|ways| ways.into_pyarray(py))))
    }

    /// Returns the ambient light.
    fn ambient(&self, py: Python<'_>) -> [f32; 3] {
        self.data(py).builder.scene().environment().ambient
    }

    /// Returns the bytes that the world holds.
    fn memory_len(&self, py: Python<'_>) -> usize {
        self.data(py).builder.memory_len()
    }

    fn pose<'py>(&self, py: Python<'py>, body: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let data = self.data(py);
        let body = data.bodies.get(body).ok_or_else(|| no_body(body, &data))?;
        Ok(PyArray1::from_slice(py, &poses::numbers(&body.pose)))
    }

    fn set_pose(&self, py: Python<'_>, body: usize, pose: PyReadonlyArrayDyn<'_, f64>) -> PyResult<()> {
        let world_from_body = poses::read("pose", &pose)?.into_iter().next().unwrap_or_default();
        self.change(py, |data| {
            let Data { builder, bodies, .. } = data;
            let count = bodies.len();
            let body = bodies
                .get_mut(body)
                .ok_or_else(|| of("body", format_args!("there is no body {body}; the world has {count}")))?;
            for (instance, body_from_part) in &body.parts {
                builder.set_pose(*instance, world_from_body * *body_from_part).map_err(of_shape)?;
            }
            body.pose = world_from_body;
            Ok(())
        })
    }

    /// Adds a shape with its dimensions: a box of three edges and so on.
    fn add_shape(
        &self,
        py: Python<'_>,
        kind: &str,
        size: Vec<f64>,
        look: Look<'_>,
        said: Said<'_>,
    ) -> PyResult<usize> {
        let shape = match (kind, &size[..]) {
            ("box", &[x, y, z]) => Shape::Box { size: [x, y, z] },
            ("rectangle", &[x, y]) => Shape::Rectangle { size: [x, y] },
            ("plane", []) => Shape::Plane,
            ("sphere", &[radius]) => Shape::Sphere { radius },
            ("ellipsoid", &[a, b, c]) => Shape::Ellipsoid { radii: [a, b, c] },
            ("cylinder", &[radius, length]) => Shape::Cylinder { radius, length },
            ("capsule", &[radius, length]) => Shape::Capsule { radius, length },
            ("cone", &[radius, length]) => Shape::Cone { radius, length },
            _ => return Err(of("size", format_args!("{size:?} is not the size of a {kind}"))),
        };
        self.add(py, |_| Ok(shape), look, said)
    }

    fn add_mesh(
        &self,
        py: Python<'_>,
        vertices: PyReadonlyArrayDyn<'_, f32>,
        faces: PyReadonlyArrayDyn<'_, u32>,
        uvs: Option<PyReadonlyArrayDyn<'_, f32>>,
        normals: Option<PyReadonlyArrayDyn<'_, f32>>,
        look: Look<'_>,
        said: Said<'_>,
    ) -> PyResult<usize> {
        let positions = triples::<f32, 3>("vertices", &vertices)?;
        let triangles = triples::<u32, 3>("faces", &faces)?;
        let uvs = uvs.as_ref().map(|uvs| triples::<f32, 2>("uvs", uvs)).transpose()?.unwrap_or_default();
        let normals = normals.as_ref().map(|normals| triples::<f32, 3>("normals", normals));
        let normals = normals.transpose()?.unwrap_or_default();
        if triangles.is_empty() {
            return Err(of("faces", "there are none; a mesh has one triangle at least"));
        }
        let mut mesh = None;
        let added = self.add(
            py,
            |builder| {
                let id = builder.add_mesh(&positions, &uvs, &triangles).map_err(of_shape)?;
                mesh = Some(id);
                builder.set_mesh_normals(id, &normals).map_err(of_shape)?;
                Ok(Shape::Mesh(id))
            },
            look,
            said,
        );
        if let (Err(_), Some(mesh)) = (&added, mesh) {
            // No instance uses it.
            let _ = self.change(py, |data| Ok(data.builder.remove_mesh(mesh)));
        }
        added
    }

    /// Adds a terrain of `rows` × `columns` heights, row by row from +y to −y.
    fn add_height_field(
        &self,
        py: Python<'_>,
        heights: PyReadonlyArrayDyn<'_, f32>,
        shape: [u32; 2],
        size: [f64; 2],
        look: Look<'_>,
        said: Said<'_>,
    ) -> PyResult<usize> {
        let heights = heights.as_slice().map_err(|error| of("heights", error))?;
        let mut field = None;
        let added = self.add(
            py,
            |builder| {
                let id = builder.add_height_field(shape[0], shape[1], size, heights).map_err(of_shape)?;
                field = Some(id);
                Ok(Shape::HeightField(id))
            },
            look,
            said,
        );
        if let (Err(_), Some(field)) = (&added, field) {
            // No instance uses it.
            let _ = self.change(py, |data| Ok(data.builder.remove_height_field(field)));
        }
        added
    }

    /// Adds a body with the shape and the surface of another one. They share triangles and texture; the surface has the
    /// given colour, if there is one. Scale and class are the other one's if they are not given.
    fn add_copy(
        &self,
        py: Python<'_>,
        body: usize,
        name: String,
        pose: PyReadonlyArrayDyn<'_, f64>,
        color: Option<[f32; 4]>,
        scale: Option<[f64; 3]>,
        class_id: Option<u32>,
    ) -> PyResult<usize> {
        let world_from_instance = poses::read("pose", &pose)?.into_iter().next().unwrap_or_default();
        self.change(py, |data| {
            let source = data.bodies.get(body).ok_or_else(|| no_body(body, data))?;
            let Some(origin) = source.origin.as_deref().cloned() else {
                let name = &source.name;
                return Err(of(
                    "body",
                    format_args!("{name:?} was read from a file; one that was added is expected"),
                ));
            };
            let name = new_name(data, name)?;
            let mut config = origin.material;
            if let Some([r, g, b, alpha]) = color {
                config = MaterialConfig { diffuse: [r, g, b], ambient: [r, g, b], alpha, ..config };
            }
            // Its own, since a batch changes the colours of each body.
            let material = data.builder.add_material(&config).map_err(of_shape)?;
            let instance = InstanceConfig {
                world_from_instance,
                scale: scale.unwrap_or(origin.instance.scale),
                material,
                class: class_id.unwrap_or(origin.instance.class),
                ..origin.instance
            };
            push_instance(data, name, Origin { instance, material: config }).inspect_err(|_| {
                // No instance uses it.
                let _ = data.builder.remove_material(material);
            })
        })
    }

    /// Adds a lamp: `point`, `directional` or `spot`; angles are half angles of the cone.
    fn add_light(
        &self,
        py: Python<'_>,
        kind: &str,
        position: [f64; 3],
        direction: [f64; 3],
        diffuse: [f32; 3],
        specular: [f32; 3],
        range_m: f32,
        attenuation: [f32; 3],
        cone: [f32; 3],
        cast_shadows: bool,
    ) -> PyResult<u32> {
        let [inner, outer, falloff] = cone;
        let kind = match kind {
            "directional" => LightKind::Directional { direction },
            "spot" => {
                let (cos_inner, cos_outer) = (inner.cos(), outer.cos());
                LightKind::Spot { position, direction, cos_inner, cos_outer, falloff }
            }
            _ => LightKind::Point { position },
        };
        let config = LightConfig { kind, diffuse, specular, range_m, attenuation, cast_shadows };
        self.change(py, |data| Ok(data.builder.add_light(&config).map_err(of_shape)?.0))
    }

    fn set_environment(&self, py: Python<'_>, ambient: [f32; 3], background: [f32; 3]) -> PyResult<()> {
        self.change(py, |data| {
            data.builder.set_environment(Environment { ambient, background });
            Ok(())
        })
    }

    /// Sets the sky to the six faces of a cube with this number of columns each, or removes it.
    fn set_sky(&self, py: Python<'_>, faces: Option<(PyReadonlyArrayDyn<'_, u8>, u32)>) -> PyResult<()> {
        let faces = match &faces {
            Some((texels, size)) => Some((texels_of("faces", texels)?, *size)),
            None => None,
        };
        self.change(py, |Data { builder, .. }| {
            let cube = faces.map(|(texels, size)| builder.add_cube_texture(size, texels)).transpose();
            let cube = cube.map_err(|error| of("faces", error))?;
            let old = builder.scene().air();
            let air = Air { sky: cube.map(Sky::Cube), ..old };
            builder.set_air(air).map_err(|error| of("faces", error))?;
            if let Some(Sky::Cube(texture)) = old.sky {
                // Nothing else uses it.
                let _ = builder.remove_texture(texture);
            }
            Ok(())
        })
    }

    /// Casts arbitrary rays.
    fn cast(
        &self,
        py: Python<'_>,
        origins: PyReadonlyArrayDyn<'_, f32>,
        directions: PyReadonlyArrayDyn<'_, f32>,
        ranges: Option<PyReadonlyArrayDyn<'_, f32>>,
        reference: [f64; 3],
        visibility: u32,
        both_faces: bool,
        moves: &Bound<'_, PyAny>,
        outputs: &Bound<'_, PyDict>,
        threads: usize,
    ) -> PyResult<()> {
        let origins = triples::<f32, 3>("origins", &origins)?;
        let directions = triples::<f32, 3>("directions", &directions)?;
        let ranges = ranges.as_ref().map(|ranges| triples::<f32, 2>("ranges", ranges)).transpose()?;
        let rays = cast::Rays { origins, directions, ranges, reference, visibility, both_faces };
        cast::cast(py, self.data(py), &rays, moves, outputs, threads)
    }
}

fn no_body(body: usize, data: &Data) -> PyErr {
    of("body", format_args!("there is no body {body}; the world has {}", data.bodies.len()))
}

/// Returns the rows of a contiguous array, each of `N` numbers.
fn triples<T: numpy::Element + bytemuck::Pod, const N: usize>(
    argument: &str,
    array: &PyReadonlyArrayDyn<'_, T>,
) -> PyResult<Vec<[T; N]>>
where
    [T; N]: bytemuck::Pod,
{
    let numbers = array.as_slice().map_err(|error| of(argument, error))?;
    let rows: &[[T; N]] = bytemuck::try_cast_slice(numbers)
        .map_err(|_| of(argument, format_args!("{} numbers are not rows of {N}", numbers.len())))?;
    Ok(rows.to_vec())
}
