//! The whole configuration: data, meshes, participants, connections and coupling schemes.

use crate::element::{Element, Strangers};
use crate::error::ConfigError;
use crate::participant::{Constraint, Direction, Mapping, MappingKind, MeshData, Participant};
use crate::scheme::CouplingScheme;
use crate::words::words;

pub use crate::element::Unknown;

/// A configuration. All names that its elements use are defined in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Configuration {
    /// Data, in the order of the file.
    pub data: Vec<Data>,
    /// Meshes, in the order of the file.
    pub meshes: Vec<Mesh>,
    /// Participants, in the order of the file.
    pub participants: Vec<Participant>,
    /// Connections between participants.
    pub connections: Vec<Connection>,
    /// Coupling schemes; several of them form a compositional scheme.
    pub schemes: Vec<CouplingScheme>,
    /// Elements that concern the library itself: logging and profiling.
    pub services: Vec<Service>,
    /// Line of the root element, if it allows meshes that change during the run.
    pub remeshing: Option<usize>,
    /// Elements and attributes that were not understood.
    pub unknown: Vec<Unknown>,
}

words! {
    /// Kind of data.
    DataKind {
        /// One number at a vertex.
        Scalar = "scalar",
        /// A number for each dimension of the mesh at a vertex.
        Vector = "vector",
    }
}

/// Data that participants exchange.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Name.
    pub name: String,
    /// Kind.
    pub kind: DataKind,
    /// Polynomial degree of the interpolation in time.
    pub waveform_degree: i64,
    /// Values have a lower or an upper bound, which quasi-Newton methods respect.
    pub bounded: bool,
    /// Line of the element.
    pub line: usize,
}

/// A mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Name.
    pub name: String,
    /// Dimensions of space: 2 or 3.
    pub dimensions: usize,
    /// Names of its data.
    pub data: Vec<String>,
    /// Line of the element.
    pub line: usize,
}

/// A connection between two participants, `m2n:KIND`.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// Kind: `sockets`, `mpi` or `mpi-multiple-ports`.
    pub kind: String,
    /// Participant that accepts the connection.
    pub acceptor: String,
    /// Participant that makes the connection.
    pub connector: String,
    /// Line of the element.
    pub line: usize,
}

/// An element that concerns the library itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Service {
    /// Name of the element.
    pub element: String,
    /// Line of the element.
    pub line: usize,
}

impl Configuration {
    pub(crate) fn read(root: &Element<'_>) -> Result<Self, ConfigError> {
        let mut strangers = Strangers::default();
        strangers.attributes(root, &["experimental", "allow-remeshing", "wait-in-finalize"]);
        let mut configuration = Self {
            data: Vec::new(),
            meshes: Vec::new(),
            participants: Vec::new(),
            connections: Vec::new(),
            schemes: Vec::new(),
            services: Vec::new(),
            remeshing: root.flag("allow-remeshing")?.then_some(root.line),
            unknown: Vec::new(),
        };
        for element in root.children() {
            let strangers = &mut strangers;
            match element.split() {
                ("data", _) => configuration.data.extend(Data::read(&element, strangers)?),
                ("", "mesh") => configuration.meshes.push(Mesh::read(&element, strangers)?),
                ("", "participant") => {
                    configuration.participants.push(Participant::read(&element, strangers)?);
                }
                ("m2n", _) => {
                    configuration.connections.push(Connection::read(&element, strangers)?);
                }
                ("coupling-scheme", _) => {
                    configuration.schemes.extend(CouplingScheme::read(&element, strangers)?);
                }
                ("", "log" | "profiling") => configuration
                    .services
                    .push(Service { element: element.name.to_owned(), line: element.line }),
                _ => strangers.element(&element),
            }
        }
        configuration.unknown = strangers.0;
        Ok(configuration)
    }

    /// Returns the participant with this name.
    #[must_use]
    pub fn participant(&self, name: &str) -> Option<&Participant> {
        self.participants.iter().find(|participant| participant.name == name)
    }

    /// Returns the mesh with this name.
    #[must_use]
    pub fn mesh(&self, name: &str) -> Option<&Mesh> {
        self.meshes.iter().find(|mesh| mesh.name == name)
    }

    /// Returns the data with this name.
    #[must_use]
    pub fn data(&self, name: &str) -> Option<&Data> {
        self.data.iter().find(|data| data.name == name)
    }

    /// Returns the meshes that a participant provides, in the order of the file.
    pub fn provided_meshes<'a>(
        &'a self,
        participant: &'a Participant,
    ) -> impl Iterator<Item = &'a Mesh> {
        participant.provides.iter().filter_map(|provided| self.mesh(&provided.mesh))
    }

    /// Returns the number of components of some data on a mesh: 1, or the dimensions of the mesh.
    #[must_use]
    pub fn components(&self, of: &MeshData) -> usize {
        let vector = self.data(&of.data).is_some_and(|data| data.kind == DataKind::Vector);
        match self.mesh(&of.mesh) {
            Some(mesh) if vector => mesh.dimensions,
            _ => 1,
        }
    }

    /// Returns whether a participant has to write some data before the first window: an exchange
    /// initialises the data on the same mesh, or on a mesh to which the participant maps them.
    #[must_use]
    pub fn writes_initially(&self, participant: &Participant, written: &MeshData) -> bool {
        let reaches = |mesh: &str| {
            let mapped = participant.mappings.iter().any(|mapping| {
                mapping.direction == Direction::Write
                    && mapping.from.as_deref() == Some(written.mesh.as_str())
                    && mapping.to.as_deref() == Some(mesh)
            });
            written.mesh == mesh || mapped
        };
        self.schemes.iter().flat_map(|scheme| &scheme.exchanges).any(|exchange| {
            exchange.initialize
                && exchange.from == participant.name
                && exchange.data == written.data
                && reaches(&exchange.mesh)
        })
    }

    /// Returns whether a mapping uses the edges and triangles of a mesh: it projects onto the mesh,
    /// or scales by the areas of both meshes.
    #[must_use]
    pub fn uses_connectivity(&self, mesh: &str) -> bool {
        let mappings = self.participants.iter().flat_map(|participant| &participant.mappings);
        mappings.into_iter().any(|mapping| {
            let is = |name: &Option<String>| name.as_deref() == Some(mesh);
            let projects = matches!(
                mapping.kind,
                MappingKind::NearestProjection | MappingKind::LinearCellInterpolation
            );
            match mapping.constraint {
                Constraint::Consistent => projects && is(&mapping.from),
                Constraint::Conservative => projects && is(&mapping.to),
                _ => is(&mapping.from) || is(&mapping.to),
            }
        })
    }

    /// Returns whether a mapping that moves this data is conservative.
    #[must_use]
    pub fn is_conservative(&self, data: &str) -> bool {
        self.mappings_of(data).any(|mapping| mapping.constraint == Constraint::Conservative)
    }

    /// Returns the mappings that move this data between two meshes.
    pub fn mappings_of(&self, data: &str) -> impl Iterator<Item = &Mapping> {
        let carries = move |mesh: &Option<String>| match mesh {
            // The vertices of a just-in-time mapping belong to no mesh.
            None => true,
            Some(name) => self.mesh(name).is_some_and(|mesh| mesh.data.iter().any(|d| d == data)),
        };
        self.participants.iter().flat_map(move |participant| {
            participant.mappings.iter().filter(move |mapping| {
                let (used, place) = match mapping.direction {
                    Direction::Write => (&participant.writes, mapping.from.as_ref()),
                    Direction::Read => (&participant.reads, mapping.to.as_ref()),
                };
                let place = place.or(mapping.from.as_ref()).or(mapping.to.as_ref());
                let named = used.iter().any(|of| of.data == data && Some(&of.mesh) == place);
                named && carries(&mapping.from) && carries(&mapping.to)
            })
        })
    }
}

impl Data {
    const BOUNDS: [&'static str; 8] = [
        "lower-bound",
        "lower-bound-x",
        "lower-bound-y",
        "lower-bound-z",
        "upper-bound",
        "upper-bound-x",
        "upper-bound-y",
        "upper-bound-z",
    ];

    /// Reads data; `None` for a kind that is unknown.
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Option<Self>, ConfigError> {
        let kind = match element.split().1 {
            "scalar" => DataKind::Scalar,
            "vector" => DataKind::Vector,
            _ => {
                strangers.element(element);
                return Ok(None);
            }
        };
        let known: Vec<&str> =
            ["name", "waveform-degree"].into_iter().chain(Self::BOUNDS).collect();
        strangers.attributes(element, &known);
        strangers.children(element);
        Ok(Some(Self {
            name: element.text("name")?,
            kind,
            waveform_degree: element.integer("waveform-degree")?.unwrap_or(1),
            bounded: Self::BOUNDS.iter().any(|bound| element.optional(bound).is_some()),
            line: element.line,
        }))
    }
}

impl Mesh {
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Self, ConfigError> {
        strangers.attributes(element, &["name", "dimensions"]);
        let dimensions = element.choice::<Dimensions>("dimensions")?;
        let dimensions = match element.required("dimensions", dimensions)? {
            Dimensions::Two => 2,
            Dimensions::Three => 3,
        };
        let mut data = Vec::new();
        for child in element.children() {
            match child.name {
                "use-data" => {
                    strangers.attributes(&child, &["name"]);
                    data.push(child.text("name")?);
                }
                _ => strangers.element(&child),
            }
        }
        Ok(Self { name: element.text("name")?, dimensions, data, line: element.line })
    }
}

words! {
    /// Dimensions of a mesh.
    Dimensions {
        /// In a plane.
        Two = "2",
        /// In space.
        Three = "3",
    }
}

impl Connection {
    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Self, ConfigError> {
        strangers.attributes(
            element,
            &[
                "acceptor",
                "connector",
                "port",
                "network",
                "exchange-directory",
                "enforce-gather-scatter",
                "use-two-level-initialization",
            ],
        );
        strangers.children(element);
        Ok(Self {
            kind: element.split().1.to_owned(),
            acceptor: element.text("acceptor")?,
            connector: element.text("connector")?,
            line: element.line,
        })
    }
}
