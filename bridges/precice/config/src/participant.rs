//! Participants: their meshes, data, mappings and outputs.

use crate::element::{Element, Strangers};
use crate::error::ConfigError;
use crate::words::{Words, words};

/// A participant.
#[derive(Clone, Debug, PartialEq)]
pub struct Participant {
    /// Name.
    pub name: String,
    /// Meshes that it provides.
    pub provides: Vec<ProvidedMesh>,
    /// Meshes of other participants that it receives.
    pub receives: Vec<ReceivedMesh>,
    /// Data that it reads.
    pub reads: Vec<MeshData>,
    /// Data that it writes.
    pub writes: Vec<MeshData>,
    /// Mappings that it does.
    pub mappings: Vec<Mapping>,
    /// Exports of its meshes to files.
    pub exports: Vec<Export>,
    /// Points and integrals whose values are written to files.
    pub watches: Vec<Watch>,
    /// Actions on data.
    pub actions: Vec<Action>,
    /// Line of the communication between its own processes, if the file describes it.
    pub intra_comm: Option<usize>,
    /// Line of the element.
    pub line: usize,
}

/// A mesh that a participant provides.
#[derive(Clone, Debug, PartialEq)]
pub struct ProvidedMesh {
    /// Name of the mesh.
    pub mesh: String,
    /// Line of the element.
    pub line: usize,
}

/// A mesh that a participant receives.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceivedMesh {
    /// Name of the mesh.
    pub mesh: String,
    /// Participant that provides it.
    pub from: String,
    /// The program may read and write data on this mesh itself.
    pub api_access: bool,
    /// Enlargement of the region that is received; the default is 0.5.
    pub safety_factor: f64,
    /// Line of the element.
    pub line: usize,
}

/// Data on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshData {
    /// Name of the mesh.
    pub mesh: String,
    /// Name of the data.
    pub data: String,
    /// Line of the element.
    pub line: usize,
}

words! {
    /// Method of a mapping.
    MappingKind {
        /// Value of the nearest vertex.
        NearestNeighbor = "nearest-neighbor",
        /// Value at the nearest point of the surface.
        NearestProjection = "nearest-projection",
        /// Value and gradient of the nearest vertex.
        NearestNeighborGradient = "nearest-neighbor-gradient",
        /// Linear interpolation within cells.
        LinearCellInterpolation = "linear-cell-interpolation",
        /// Radial basis functions, with a solver chosen by the library.
        Rbf = "rbf",
        /// Radial basis functions, one direct solve.
        RbfGlobalDirect = "rbf-global-direct",
        /// Radial basis functions, one iterative solve.
        RbfGlobalIterative = "rbf-global-iterative",
        /// Radial basis functions in overlapping clusters.
        RbfPumDirect = "rbf-pum-direct",
        /// Averages of particles.
        CoarseGraining = "coarse-graining",
        /// Between a line and a volume, along their common axis.
        AxialGeometricMultiscale = "axial-geometric-multiscale",
        /// Between a line and a volume, across their common axis.
        RadialGeometricMultiscale = "radial-geometric-multiscale",
    }
}

impl MappingKind {
    /// Returns whether the method has radial basis functions.
    #[must_use]
    pub fn is_radial(self) -> bool {
        matches!(
            self,
            Self::Rbf | Self::RbfGlobalDirect | Self::RbfGlobalIterative | Self::RbfPumDirect
        )
    }
}

words! {
    /// Direction of a mapping.
    Direction {
        /// After writing, before the exchange.
        Write = "write",
        /// Before reading, after the exchange.
        Read = "read",
    }
}

words! {
    /// Quantity that a mapping keeps.
    Constraint {
        /// Values; constants stay constant.
        Consistent = "consistent",
        /// Sum over all vertices.
        Conservative = "conservative",
        /// Values, scaled so that the integral over the surface is kept.
        ScaledConsistentSurface = "scaled-consistent-surface",
        /// Values, scaled so that the integral over the volume is kept.
        ScaledConsistentVolume = "scaled-consistent-volume",
    }
}

/// A mapping between two meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapping {
    /// Method.
    pub kind: MappingKind,
    /// Direction.
    pub direction: Direction,
    /// Mesh of the source; `None` for places that the program names at run time.
    pub from: Option<String>,
    /// Mesh of the target; `None` for places that the program names at run time.
    pub to: Option<String>,
    /// Quantity that is kept.
    pub constraint: Constraint,
    /// Radial basis function.
    pub basis: Option<BasisFunction>,
    /// Further options of the method, with their values.
    pub options: Vec<(String, String)>,
    /// Line of the element.
    pub line: usize,
}

/// A radial basis function, `basis-function:NAME`.
#[derive(Clone, Debug, PartialEq)]
pub struct BasisFunction {
    /// Name.
    pub name: String,
    /// Radius beyond which the function is zero.
    pub support_radius: Option<f64>,
    /// Parameter of the shape.
    pub shape_parameter: Option<f64>,
    /// Line of the element.
    pub line: usize,
}

/// An export of meshes to files, `export:FORMAT`.
#[derive(Clone, Debug, PartialEq)]
pub struct Export {
    /// Format: `vtk`, `vtu`, `vtp` or `csv`.
    pub format: String,
    /// Folder of the files.
    pub directory: String,
    /// Windows between exports; -1 for none.
    pub every_windows: i64,
    /// Every iteration is exported.
    pub every_iteration: bool,
    /// Line of the element.
    pub line: usize,
}

/// A point or an integral whose values are written to a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Watch {
    /// Name of the element: `watch-point` or `watch-integral`.
    pub element: String,
    /// Name.
    pub name: String,
    /// Name of the mesh.
    pub mesh: String,
    /// Line of the element.
    pub line: usize,
}

/// An action on data, `action:KIND`.
#[derive(Clone, Debug, PartialEq)]
pub struct Action {
    /// Kind.
    pub kind: String,
    /// Name of the mesh.
    pub mesh: String,
    /// Names of the data that it changes.
    pub targets: Vec<String>,
    /// Line of the element.
    pub line: usize,
}

impl Participant {
    /// Returns whether the participant provides or receives this mesh.
    #[must_use]
    pub fn uses(&self, mesh: &str) -> bool {
        self.provides(mesh) || self.receives.iter().any(|received| received.mesh == mesh)
    }

    /// Returns whether the participant provides this mesh.
    #[must_use]
    pub fn provides(&self, mesh: &str) -> bool {
        self.provides.iter().any(|provided| provided.mesh == mesh)
    }

    pub(crate) fn read(
        element: &Element<'_>,
        strangers: &mut Strangers,
    ) -> Result<Self, ConfigError> {
        strangers.attributes(element, &["name"]);
        let mut participant = Self {
            name: element.text("name")?,
            provides: Vec::new(),
            receives: Vec::new(),
            reads: Vec::new(),
            writes: Vec::new(),
            mappings: Vec::new(),
            exports: Vec::new(),
            watches: Vec::new(),
            actions: Vec::new(),
            intra_comm: None,
            line: element.line,
        };
        for child in element.children() {
            participant.add(&child, strangers)?;
        }
        Ok(participant)
    }

    fn add(&mut self, element: &Element<'_>, strangers: &mut Strangers) -> Result<(), ConfigError> {
        let line = element.line;
        match element.split() {
            ("", "provide-mesh") => {
                strangers.attributes(element, &["name"]);
                self.provides.push(ProvidedMesh { mesh: element.text("name")?, line });
            }
            ("", "receive-mesh") => self.receives.push(ReceivedMesh::read(element, strangers)?),
            ("", "read-data") => self.reads.push(MeshData::read(element, "name", strangers)?),
            ("", "write-data") => self.writes.push(MeshData::read(element, "name", strangers)?),
            ("mapping", _) => self.mappings.extend(Mapping::read(element, strangers)?),
            ("export", _) => self.exports.push(Export::read(element, strangers)?),
            ("", "watch-point" | "watch-integral") => {
                strangers.attributes(
                    element,
                    &["name", "mesh", "coordinate", "scale-with-connectivity"],
                );
                self.watches.push(Watch {
                    element: element.name.to_owned(),
                    name: element.text("name")?,
                    mesh: element.text("mesh")?,
                    line,
                });
            }
            ("action", _) => self.actions.push(Action::read(element, strangers)?),
            ("intra-comm", _) => self.intra_comm = Some(line),
            _ => strangers.element(element),
        }
        Ok(())
    }
}

impl ReceivedMesh {
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Self, ConfigError> {
        strangers.attributes(
            element,
            &["name", "from", "api-access", "direct-access", "safety-factor", "geometric-filter"],
        );
        Ok(Self {
            mesh: element.text("name")?,
            from: element.text("from")?,
            // Both names are in use; the second one is the older.
            api_access: element.flag("api-access")? || element.flag("direct-access")?,
            safety_factor: element.number("safety-factor")?.unwrap_or(0.5),
            line: element.line,
        })
    }
}

impl MeshData {
    /// Reads data and mesh; `attribute` has the name of the data.
    pub(crate) fn read(
        element: &Element<'_>,
        attribute: &'static str,
        strangers: &mut Strangers,
    ) -> Result<Self, ConfigError> {
        strangers.attributes(element, &[attribute, "mesh"]);
        Ok(Self { mesh: element.text("mesh")?, data: element.text(attribute)?, line: element.line })
    }
}

impl Mapping {
    /// Options that only some methods have.
    const OPTIONS: [&'static str; 15] = [
        "polynomial",
        "x-dead",
        "y-dead",
        "z-dead",
        "solver-rtol",
        "vertices-per-cluster",
        "relative-overlap",
        "project-to-input",
        "radius",
        "multiscale-dimension",
        "multiscale-type",
        "multiscale-axis",
        "multiscale-radius",
        "multiscale-cross-section-profile",
        "multiscale-cross-section",
    ];

    /// Reads a mapping; `None` for a method that is unknown.
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Option<Self>, ConfigError> {
        let Some(kind) = MappingKind::from_word(element.split().1) else {
            strangers.element(element);
            return Ok(None);
        };
        let common = ["direction", "from", "to", "constraint"];
        let known: Vec<&str> = common.into_iter().chain(Self::OPTIONS).collect();
        strangers.attributes(element, &known);
        let mut options: Vec<(String, String)> = Self::OPTIONS
            .iter()
            .filter_map(|name| Some(((*name).to_owned(), element.optional(name)?.to_owned())))
            .collect();
        element.at_most_once(&["basis-function:", "executor:"])?;
        let mut basis = None;
        for child in element.children() {
            match child.split() {
                ("basis-function", name) => {
                    strangers.attributes(&child, &["support-radius", "shape-parameter"]);
                    basis = Some(BasisFunction {
                        name: name.to_owned(),
                        support_radius: child.above_zero("support-radius")?,
                        shape_parameter: child.above_zero("shape-parameter")?,
                        line: child.line,
                    });
                }
                ("executor", name) => options.push(("executor".to_owned(), name.to_owned())),
                _ => strangers.element(&child),
            }
        }
        let named = |attribute| {
            element.optional(attribute).filter(|name| !name.is_empty()).map(str::to_owned)
        };
        Ok(Some(Self {
            kind,
            direction: element.required("direction", element.choice("direction")?)?,
            from: named("from"),
            to: named("to"),
            constraint: element.required("constraint", element.choice("constraint")?)?,
            basis,
            options,
            line: element.line,
        }))
    }
}

impl Export {
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Self, ConfigError> {
        strangers.attributes(
            element,
            &["directory", "every-n-time-windows", "every-iteration", "update-series"],
        );
        Ok(Self {
            format: element.split().1.to_owned(),
            directory: element.optional("directory").unwrap_or(".").to_owned(),
            every_windows: element.integer("every-n-time-windows")?.unwrap_or(1),
            every_iteration: element.flag("every-iteration")?,
            line: element.line,
        })
    }
}

impl Action {
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Self, ConfigError> {
        strangers.attributes(element, &["timing", "mesh"]);
        let mut targets = Vec::new();
        for child in element.children() {
            match child.name {
                "target-data" => targets.push(child.text("name")?),
                "source-data" | "path" | "module" => {}
                _ => strangers.element(&child),
            }
        }
        Ok(Self {
            kind: element.split().1.to_owned(),
            mesh: element.text("mesh")?,
            targets,
            line: element.line,
        })
    }
}
