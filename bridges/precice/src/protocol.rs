//! Messages between the library in a program and its launcher, over a local socket.
//!
//! The program asks and the launcher answers, strictly in turn. A message is a 64-bit length in
//! little-endian order and the message in binary form. Values of a field are in the order of the
//! contract: all points of the first component, then of the second.

use proto::binary;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{self, Read, Write};

/// Version of the messages; library and launcher of one build have the same.
pub const VERSION: u32 = 1;

/// Environment variable with the path of the launcher's socket.
pub const SOCKET: &str = "COSIM_PRECICE_SOCKET";

/// Size of the length before a message [byte].
const LENGTH: usize = 8;

/// Message from the program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// The program has created its participant.
    Create {
        /// [`VERSION`] of the library.
        version: u32,
        /// Name of the participant.
        participant: String,
    },
    /// The program has set its meshes, and waits for the first window.
    Initialise {
        /// Meshes in the order of [`Interface::meshes`].
        meshes: Vec<Mesh>,
        /// Initial values of the written data, in the order of [`Interface::written`].
        #[serde(with = "raw")]
        values: Vec<Vec<f64>>,
    },
    /// The program has computed the window, and waits for the next.
    Advance {
        /// Values of the written data at the end of the window.
        #[serde(with = "raw")]
        values: Vec<Vec<f64>>,
        /// Number of the program's time steps in the window.
        steps: u32,
    },
    /// The program ends its part.
    Finalise,
    /// A call of the program was refused; the program ends.
    Fail {
        /// Name of the function and reason.
        reason: String,
    },
}

/// Message from the launcher.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// Answer to [`Request::Create`].
    Interface(Interface),
    /// Answer to [`Request::Initialise`] and [`Request::Advance`]: the window to solve.
    Window(Window),
    /// Answer to [`Request::Initialise`] and [`Request::Advance`]: the simulation has ended.
    Ended,
    /// The request is refused, with the reason.
    Refused(String),
}

/// Meshes and data of a participant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    /// Meshes that the program provides.
    pub meshes: Vec<MeshInfo>,
    /// Meshes that the program receives from others.
    pub received: Vec<MeshInfo>,
    /// Data that the program reads.
    pub read: Vec<DataInfo>,
    /// Data that the program writes.
    pub written: Vec<DataInfo>,
}

/// Name and dimension of a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshInfo {
    /// Name.
    pub name: String,
    /// Number of coordinates of a vertex: 2 or 3.
    pub dimensions: usize,
    /// True if a mapping of the configuration uses edges and triangles of the mesh.
    pub connected: bool,
}

/// Data on a mesh.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DataInfo {
    /// Index in [`Interface::meshes`].
    pub mesh: usize,
    /// Name.
    pub name: String,
    /// Number of components: 1, or the dimension of the mesh.
    pub components: usize,
    /// True if the program gives initial values.
    pub initial: bool,
}

/// Vertices of a mesh with their connectivity.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Vertices; the third coordinate of a plane mesh is 0.
    pub points: Vec<[f64; 3]>,
    /// Edges by the indices of their vertices.
    pub edges: Vec<[u32; 2]>,
    /// Triangles by the indices of their vertices.
    pub triangles: Vec<[u32; 3]>,
}

/// Window to solve, with the values to read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Length [s].
    pub length: f64,
    /// True for a further iteration of the window that was solved last.
    pub repeats: bool,
    /// Values at the end of the window, in the order of [`Interface::read`].
    #[serde(with = "raw")]
    pub ends: Vec<Vec<f64>>,
    /// Values at the start of the window; empty for data that is constant within a window.
    #[serde(with = "raw")]
    pub starts: Vec<Vec<f64>>,
}

/// Lists of values as bytes, which are copied as a whole instead of number by number.
mod raw {
    use serde::de::{Error, Visitor};
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use std::fmt;
    use zerocopy::IntoBytes as _;

    struct Values(Vec<f64>);
    struct Bytes<'a>(&'a [f64]);

    impl Serialize for Bytes<'_> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.serialize_bytes(self.0.as_bytes())
        }
    }

    impl<'de> Deserialize<'de> for Values {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            struct Reader;
            impl Visitor<'_> for Reader {
                type Value = Values;

                fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                    f.write_str("numbers of eight bytes each")
                }

                fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Values, E> {
                    let (numbers, rest) = bytes.as_chunks();
                    match rest.len() {
                        0 => Ok(Values(numbers.iter().map(|n| f64::from_ne_bytes(*n)).collect())),
                        _ => Err(E::invalid_length(bytes.len(), &self)),
                    }
                }

                fn visit_byte_buf<E: Error>(self, bytes: Vec<u8>) -> Result<Values, E> {
                    self.visit_bytes(&bytes)
                }
            }
            deserializer.deserialize_bytes(Reader)
        }
    }

    pub(super) fn serialize<S: Serializer>(
        lists: &[Vec<f64>],
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(lists.iter().map(|values| Bytes(values)))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        deserializer: D,
    ) -> Result<Vec<Vec<f64>>, D::Error> {
        let lists = Vec::<Values>::deserialize(deserializer)?;
        Ok(lists.into_iter().map(|Values(values)| values).collect())
    }
}

/// Sends a message.
///
/// # Errors
/// Fails if writing fails.
pub fn send(
    into: &mut impl Write,
    message: &impl Serialize,
    buffer: &mut Vec<u8>,
) -> io::Result<()> {
    buffer.clear();
    buffer.extend([0; LENGTH]);
    binary::append(buffer, message).map_err(io::Error::other)?;
    let length = (buffer.len() - LENGTH) as u64;
    buffer[..LENGTH].copy_from_slice(&length.to_le_bytes());
    into.write_all(buffer)
}

/// Receives a message.
///
/// # Errors
/// Fails if reading fails, or the message is malformed or too large.
pub fn receive<T: DeserializeOwned>(from: &mut impl Read, buffer: &mut Vec<u8>) -> io::Result<T> {
    let mut length = [0; LENGTH];
    from.read_exact(&mut length)?;
    let length = u64::from_le_bytes(length);
    let malformed = |reason: String| io::Error::new(io::ErrorKind::InvalidData, reason);
    if length > binary::LONGEST as u64 {
        return Err(malformed(format!("a message claims {length} bytes")));
    }
    buffer.clear();
    // `take` limits the memory to the bytes that arrive.
    if from.take(length).read_to_end(buffer)? as u64 != length {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    binary::read(buffer).map_err(malformed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_message_arrives_as_it_was_sent() {
        let request = Request::Advance { values: vec![vec![1.0 / 3.0, -0.0], vec![]], steps: 3 };
        let mut bytes = Vec::new();
        send(&mut bytes, &request, &mut Vec::new()).unwrap();
        assert_eq!(receive::<Request>(&mut &bytes[..], &mut Vec::new()).unwrap(), request);
        let cut = &mut &bytes[..bytes.len() - 1];
        let error = receive::<Request>(cut, &mut Vec::new()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::UnexpectedEof);
    }

    proptest! {
        #[test]
        fn any_bytes_give_a_message_or_an_error(bytes: Vec<u8>) {
            let mut framed = (bytes.len() as u64).to_le_bytes().to_vec();
            framed.extend(&bytes);
            let _ = receive::<Request>(&mut &framed[..], &mut Vec::new());
            let _ = receive::<Answer>(&mut &bytes[..], &mut Vec::new());
        }
    }
}
