//! Meshes and data of a participant, from preCICE's configuration and the wires of the command.

use super::placement::Placement;
use super::wire::{Direction, Linear, Wire};
use crate::protocol::{DataInfo, Interface, MeshInfo};
use precice_config::configuration::{Configuration, Mesh};
use precice_config::participant::{MeshData, Participant};
use proto::field::{self, Body, FieldKind, FieldSpec, Mapping};
use proto::grid::check_name;

/// Data of the program and the field to which it is wired.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledData {
    /// Data in the program.
    pub info: DataInfo,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of the field.
    pub field: String,
    /// Relation from source to target.
    pub scale: Linear,
    /// Unit of a field that no table has.
    pub unit: String,
    /// True if a conservative field has the total of each vertex, instead of a density.
    pub is_total: bool,
}

impl CoupledData {
    /// Returns the description of the field that the program gives.
    #[must_use]
    pub fn kind(&self) -> FieldKind {
        let own = || FieldKind {
            name: self.field.clone(),
            unit: self.unit.clone(),
            components: u32::try_from(self.info.components).unwrap_or(u32::MAX),
            mapping: if self.is_total { Mapping::Conservative } else { Mapping::Consistent },
            body: Body::Interface,
            meaning: format!("data {} on mesh {}", self.info.name, self.mesh),
        };
        field::find(&self.field).map_or_else(own, FieldSpec::kind)
    }

    /// Returns the field as the protocol library names it. Its names are leaked: they are few and
    /// live as long as the process.
    #[must_use]
    pub fn spec(&self, kind: &FieldKind) -> FieldSpec {
        FieldSpec {
            name: kind.name.clone().leak(),
            unit: kind.unit.clone().leak(),
            components: kind.components,
            mapping: kind.mapping,
            body: kind.body,
            meaning: "",
        }
    }
}

/// Everything that a participant exchanges.
#[derive(Clone, Debug, PartialEq)]
pub struct Coupled {
    /// Name of the participant in the configuration.
    pub participant: String,
    /// Meshes and data as the library in the program knows them.
    pub interface: Interface,
    /// Data that the program reads, in the order of the interface.
    pub read: Vec<CoupledData>,
    /// Data that the program writes, in the order of the interface.
    pub written: Vec<CoupledData>,
    /// Place of the meshes in the case.
    pub placement: Placement,
    /// Source of the model, for its description.
    pub source: String,
}

/// Reason why a participant cannot be coupled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CoupledError {
    /// The configuration has no such participant.
    #[error("the configuration has no participant `{name}`; it has: {known}")]
    Participant {
        /// Name in the command.
        name: String,
        /// Names in the configuration.
        known: String,
    },
    /// A wire names data that do not exist.
    #[error(
        "the wire {wire:?} names data that `{participant}` does not {verb}; these are: {known}"
    )]
    Wire {
        /// The wire.
        wire: String,
        /// Name of the participant.
        participant: String,
        /// `read` or `write`.
        verb: &'static str,
        /// Names of the data.
        known: String,
    },
    /// A field has another number of components than the data.
    #[error("`{data}` has {found} components, and the field `{field}` has {expected}")]
    Components {
        /// Name of the data.
        data: String,
        /// Number of components of the data.
        found: usize,
        /// Name of the field.
        field: String,
        /// Number of components of the field.
        expected: u32,
    },
    /// The unit of a known field is given differently.
    #[error("the field `{field}` is in {known}, not in {given}")]
    Unit {
        /// Name of the field.
        field: String,
        /// Unit of the field.
        known: &'static str,
        /// Unit in the wire.
        given: String,
    },
    /// Data without a wire cannot be a field by their name.
    #[error("data `{data}` needs a wire to a field: {reason}")]
    Name {
        /// Name of the data.
        data: String,
        /// Reason.
        reason: String,
    },
    /// Data have several wires.
    #[error("data `{0}` has two wires, and gives or receives one field; remove one of them")]
    SecondWire(String),
    /// A field is given or received twice.
    #[error("the field `{0}` is wired twice")]
    Twice(String),
    /// Fewer axes are given than a mesh has dimensions.
    #[error("mesh `{mesh}` has {mesh_dimensions} dimensions, and --axes has {axes}")]
    Axes {
        /// Name of the mesh.
        mesh: String,
        /// Dimensions of the mesh.
        mesh_dimensions: usize,
        /// Number of axes.
        axes: usize,
    },
    /// Components of a vector would have to be turned.
    #[error("data `{0}` is a vector, whose components --axes cannot turn; use the axes x,y,z")]
    Turned(String),
    /// Data lies on a mesh of another participant.
    #[error(
        "data `{data}` lies on the mesh `{mesh}` of another participant (direct access), which is \
         not supported; provide a mesh of its own"
    )]
    Received {
        /// Name of the data.
        data: String,
        /// Name of the mesh.
        mesh: String,
    },
}

impl Coupled {
    /// Finds the meshes and data of a participant, and applies the wires.
    ///
    /// # Errors
    /// Fails if the configuration has no such participant, or a wire does not fit.
    pub fn new(
        configuration: &Configuration,
        name: &str,
        wires: &[Wire],
        placement: Placement,
    ) -> Result<Self, CoupledError> {
        let participant =
            configuration.participant(name).ok_or_else(|| CoupledError::Participant {
                name: name.to_owned(),
                known: listed(configuration.participants.iter().map(|one| one.name.as_str())),
            })?;
        let info = |mesh: &Mesh| MeshInfo {
            name: mesh.name.clone(),
            dimensions: mesh.dimensions,
            connected: configuration.uses_connectivity(&mesh.name),
        };
        let meshes: Vec<_> = configuration.provided_meshes(participant).map(info).collect();
        let received = participant.receives.iter().filter_map(|one| configuration.mesh(&one.mesh));
        let received = received.map(info).collect();
        let view = View { configuration, participant, meshes: &meshes, wires };
        let read = view.data(Direction::Read)?;
        let written = view.data(Direction::Written)?;
        view.check_wires(Direction::Read, &read)?;
        view.check_wires(Direction::Written, &written)?;
        for mesh in &meshes {
            let (mesh_dimensions, axes) = (mesh.dimensions, placement.dimensions());
            if axes < mesh_dimensions {
                return Err(CoupledError::Axes { mesh: mesh.name.clone(), mesh_dimensions, axes });
            }
        }
        let all = || read.iter().chain(&written);
        if let Some(vector) = all().find(|data| data.info.components > 1)
            && !placement.keeps_axes()
        {
            return Err(CoupledError::Turned(vector.info.name.clone()));
        }
        let infos = |list: &[CoupledData]| list.iter().map(|data| data.info.clone()).collect();
        let interface =
            Interface { read: infos(&read), written: infos(&written), meshes, received };
        let source = "preCICE 3 participant; see the program's own documentation".to_owned();
        Ok(Self { participant: name.to_owned(), interface, read, written, placement, source })
    }
}

/// A participant with its wires.
struct View<'a> {
    configuration: &'a Configuration,
    participant: &'a Participant,
    meshes: &'a [MeshInfo],
    wires: &'a [Wire],
}

impl View<'_> {
    fn data(&self, direction: Direction) -> Result<Vec<CoupledData>, CoupledError> {
        let list = match direction {
            Direction::Read => &self.participant.reads,
            Direction::Written => &self.participant.writes,
        };
        let mut found: Vec<CoupledData> = Vec::new();
        for item in list {
            let mesh = self.meshes.iter().position(|info| info.name == item.mesh);
            let mesh = mesh.ok_or_else(|| CoupledError::Received {
                data: item.data.clone(),
                mesh: item.mesh.clone(),
            })?;
            let data = self.one(item, mesh, direction)?;
            if found.iter().any(|other| other.field == data.field) {
                return Err(CoupledError::Twice(data.field));
            }
            found.push(data);
        }
        Ok(found)
    }

    fn one(
        &self,
        item: &MeshData,
        mesh: usize,
        direction: Direction,
    ) -> Result<CoupledData, CoupledError> {
        let name = item.data.as_str();
        let components = self.configuration.components(item);
        let wire = self.wires.iter().find(|wire| wire.data == name && wire.direction == direction);
        let field = wire.map_or_else(|| name.to_owned(), |wire| wire.field.clone());
        check_name("field", &field)
            .map_err(|reason| CoupledError::Name { data: name.to_owned(), reason })?;
        let unit = wire.and_then(|wire| wire.unit.clone());
        if let Some(spec) = field::find(&field) {
            if spec.components as usize != components {
                return Err(CoupledError::Components {
                    data: name.to_owned(),
                    found: components,
                    field,
                    expected: spec.components,
                });
            }
            if let Some(given) = unit.filter(|unit| unit != spec.unit) {
                return Err(CoupledError::Unit { field, known: spec.unit, given });
            }
        }
        let unit = wire.and_then(|wire| wire.unit.clone()).unwrap_or_else(|| "1".to_owned());
        let initial = direction == Direction::Written
            && self.configuration.writes_initially(self.participant, item);
        Ok(CoupledData {
            info: DataInfo { mesh, name: name.to_owned(), components, initial },
            mesh: item.mesh.clone(),
            field,
            scale: wire.map_or(Linear::SAME, |wire| wire.scale),
            unit,
            is_total: self.configuration.is_conservative(name),
        })
    }

    /// Checks that every wire names existing data.
    fn check_wires(&self, direction: Direction, found: &[CoupledData]) -> Result<(), CoupledError> {
        let verb = match direction {
            Direction::Read => "read",
            Direction::Written => "write",
        };
        let same =
            |one: &Wire, other: &Wire| (one.direction, &one.data) == (other.direction, &other.data);
        let mut places = 0..self.wires.len();
        let second = places.find(|&k| self.wires[..k].iter().any(|one| same(one, &self.wires[k])));
        if let Some(place) = second {
            return Err(CoupledError::SecondWire(self.wires[place].data.clone()));
        }
        let unknown = self.wires.iter().find(|wire| {
            wire.direction == direction && found.iter().all(|data| data.info.name != wire.data)
        });
        unknown.map_or(Ok(()), |wire| {
            Err(CoupledError::Wire {
                wire: wire.data.clone(),
                participant: self.participant.name.clone(),
                verb,
                known: listed(found.iter().map(|data| data.info.name.as_str())),
            })
        })
    }
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    match names.collect::<Vec<_>>() {
        names if names.is_empty() => "none".to_owned(),
        names => names.join(", "),
    }
}
