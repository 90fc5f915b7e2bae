//! The participant in a program: preCICE's functions as a state machine.
//!
//! Windows and iterations are the coordinator's. [`Participant::initialize`] and the
//! [`Participant::advance`] that fills a window wait for the launcher's next answer: a further
//! iteration of the same window, the next window, or the end. Shorter steps of the program stay
//! inside the library; the values at the end of the window are sent.

use super::error::CallError;
use super::mesh::OwnMesh;
use crate::protocol::{
    self, Answer, DataInfo, Interface, Mesh, MeshInfo, Request, SOCKET, VERSION, Window,
};
use std::os::unix::net::UnixStream;

/// Rest of a window, in lengths of the window, that counts as rounding of the program's steps.
const ROUNDING: f64 = 1e-10;

/// Stage of the participant.
#[derive(Debug, PartialEq)]
enum Stage {
    Created,
    Coupling(Progress),
    Ended,
    Finalised,
}

/// State within a window.
#[derive(Debug, Default, PartialEq)]
struct Progress {
    /// Length of the window [s].
    length: f64,
    /// Time of the window that the program has computed [s].
    done: f64,
    /// Number of the program's steps in the window.
    steps: u32,
    /// True if the last advance completed an accepted window.
    completed: bool,
    /// True if the program has asked to write a checkpoint in this window.
    saved: bool,
    /// True until the program asks whether to read its checkpoint.
    must_go_back: bool,
}

impl Progress {
    fn rest(&self) -> f64 {
        (self.length - self.done).max(0.0)
    }
}

/// Values of data that the program reads, at the ends of the window.
#[derive(Debug, Default)]
struct Samples {
    /// Values at the start; empty if constant within the window.
    start: Vec<f64>,
    /// Values at the end; empty before the first window.
    end: Vec<f64>,
}

/// A participant in a program.
pub struct Participant {
    connection: UnixStream,
    interface: Interface,
    meshes: Vec<OwnMesh>,
    read: Vec<Samples>,
    /// Values of written data, NaN where not written.
    written: Vec<Vec<f64>>,
    /// True until the program asks whether to give initial data.
    initial_data: bool,
    stage: Stage,
    buffer: Vec<u8>,
}

impl Participant {
    /// Creates a participant and connects it to the launcher that started the program.
    ///
    /// # Errors
    /// Fails if the program was started by hand, has several processes, or the launcher refuses.
    pub fn create(name: &str, rank: i32, size: i32) -> Result<Self, CallError> {
        let path = std::env::var_os(SOCKET).ok_or(CallError::NotLaunched(SOCKET))?;
        let mut connection = UnixStream::connect(path)?;
        if (rank, size) != (0, 1) {
            let error = CallError::Parallel { rank, size };
            let reason = format!("createParticipant: {error}");
            protocol::send(&mut connection, &Request::Fail { reason }, &mut Vec::new())?;
            return Err(error);
        }
        Self::over(connection, name)
    }

    fn over(connection: UnixStream, name: &str) -> Result<Self, CallError> {
        let mut participant = Self {
            connection,
            interface: Interface::default(),
            meshes: Vec::new(),
            read: Vec::new(),
            written: Vec::new(),
            initial_data: false,
            stage: Stage::Created,
            buffer: Vec::new(),
        };
        let create = Request::Create { version: VERSION, participant: name.to_owned() };
        let Answer::Interface(interface) = participant.ask(&create)? else {
            return Err(CallError::Protocol);
        };
        participant.meshes = interface.meshes.iter().cloned().map(OwnMesh::new).collect();
        participant.read.resize_with(interface.read.len(), Samples::default);
        participant.written.resize_with(interface.written.len(), Vec::new);
        participant.initial_data = interface.written.iter().any(|data| data.initial);
        participant.interface = interface;
        Ok(participant)
    }

    fn ask(&mut self, request: &Request) -> Result<Answer, CallError> {
        self.send(request)?;
        match protocol::receive(&mut self.connection, &mut self.buffer)? {
            Answer::Refused(reason) => Err(CallError::Refused(reason)),
            answer => Ok(answer),
        }
    }

    fn send(&mut self, request: &Request) -> Result<(), CallError> {
        Ok(protocol::send(&mut self.connection, request, &mut self.buffer)?)
    }

    /// Tells the launcher why the program will end.
    pub fn fail(&mut self, reason: String) {
        // The program ends for this reason, even if the launcher does not hear it.
        let _ = self.send(&Request::Fail { reason });
    }

    /// Sends the meshes and the initial data, and waits for the first window.
    ///
    /// # Errors
    /// Fails if called twice, a mesh is empty, or the connection is lost.
    pub fn initialize(&mut self) -> Result<(), CallError> {
        self.must_be_created("after initialize")?;
        if let Some(empty) = self.meshes.iter().find(|mesh| mesh.size() == 0) {
            return Err(CallError::EmptyMesh(empty.info.name.clone()));
        }
        for at in 0..self.written.len() {
            self.make_room(at);
        }
        for (data, values) in self.interface.written.iter().zip(&mut self.written) {
            match data.initial {
                true => check_written(data, &self.meshes[data.mesh], values)?,
                false => values.fill(0.0),
            }
        }
        let take = |mesh: &mut OwnMesh| Mesh {
            points: mesh.mesh.points.clone(),
            edges: std::mem::take(&mut mesh.mesh.edges),
            triangles: std::mem::take(&mut mesh.mesh.triangles),
        };
        let meshes = self.meshes.iter_mut().map(take).collect();
        let request = Request::Initialise { meshes, values: self.take_written() };
        let answer = self.ask(&request)?;
        self.give_back(request);
        self.begin(answer)
    }

    /// Adds a step of the program to the window. If the window is full, sends the written data and
    /// waits for the next solve.
    ///
    /// # Errors
    /// Fails if the step does not fit the window, values are missing, the program cannot repeat a
    /// window that it has to, or the connection is lost.
    pub fn advance(&mut self, step: f64) -> Result<(), CallError> {
        let progress = self.coupling()?;
        if progress.must_go_back {
            return Err(CallError::CheckpointNotRead);
        }
        let (most, slack) = (progress.rest(), ROUNDING * progress.length);
        if !(step > 0.0 && step <= most + slack) {
            return Err(CallError::Step { step, most });
        }
        progress.done += step;
        progress.steps += 1;
        progress.completed = false;
        if progress.rest() > slack {
            return Ok(());
        }
        let (steps, saved) = (progress.steps, progress.saved);
        for (data, values) in self.interface.written.iter().zip(&self.written) {
            check_written(data, &self.meshes[data.mesh], values)?;
        }
        let request = Request::Advance { values: self.take_written(), steps };
        let answer = self.ask(&request)?;
        self.give_back(request);
        if !saved && matches!(&answer, Answer::Window(window) if window.repeats) {
            return Err(CallError::NoCheckpoint);
        }
        self.begin(answer)
    }

    /// Ends the participant. The connection is closed when it is dropped.
    ///
    /// # Errors
    /// Fails if called twice or the connection is lost.
    pub fn finalize(&mut self) -> Result<(), CallError> {
        match self.stage {
            Stage::Finalised => return Err(CallError::Order("twice")),
            // The launcher does not listen after the end.
            Stage::Ended => {}
            Stage::Created | Stage::Coupling(_) => self.send(&Request::Finalise)?,
        }
        self.stage = Stage::Finalised;
        Ok(())
    }

    fn begin(&mut self, answer: Answer) -> Result<(), CallError> {
        let Window { length, repeats, ends, starts } = match answer {
            Answer::Window(window) => window,
            Answer::Ended => {
                self.stage = Stage::Ended;
                return Ok(());
            }
            _ => return Err(CallError::Protocol),
        };
        for (at, (start, end)) in starts.into_iter().zip(ends).enumerate() {
            if end.len() != self.values_of(&self.interface.read[at]) {
                return Err(CallError::Protocol);
            }
            self.read[at] = Samples { start, end };
        }
        let first = self.stage == Stage::Created;
        self.stage = Stage::Coupling(Progress {
            length,
            completed: !first && !repeats,
            saved: repeats,
            must_go_back: repeats,
            ..Progress::default()
        });
        Ok(())
    }

    /// Takes the written values for a message; [`Self::give_back`] returns their memory.
    fn take_written(&mut self) -> Vec<Vec<f64>> {
        std::mem::take(&mut self.written)
    }

    fn give_back(&mut self, request: Request) {
        if let Request::Initialise { values, .. } | Request::Advance { values, .. } = request {
            self.written = values;
            self.written.iter_mut().for_each(|values| values.fill(f64::NAN));
        }
    }

    fn values_of(&self, data: &DataInfo) -> usize {
        data.components * self.meshes[data.mesh].size()
    }

    fn make_room(&mut self, written: usize) {
        let size = self.values_of(&self.interface.written[written]);
        self.written[written].resize(size, f64::NAN);
    }

    fn must_be_created(&self, when: &'static str) -> Result<(), CallError> {
        match self.stage {
            Stage::Created => Ok(()),
            _ => Err(CallError::Order(when)),
        }
    }

    fn coupling(&mut self) -> Result<&mut Progress, CallError> {
        match &mut self.stage {
            Stage::Coupling(progress) => Ok(progress),
            Stage::Created => Err(CallError::Order("before initialize")),
            Stage::Ended => Err(CallError::Order("after the coupling has ended")),
            Stage::Finalised => Err(CallError::Order("after finalize")),
        }
    }

    /// Returns true until the simulation has ended.
    #[must_use]
    pub fn is_coupling_ongoing(&self) -> bool {
        matches!(self.stage, Stage::Created | Stage::Coupling(_))
    }

    /// Returns true if the last advance completed a window that was accepted.
    #[must_use]
    pub fn is_time_window_complete(&self) -> bool {
        match &self.stage {
            Stage::Coupling(progress) => progress.completed,
            Stage::Created => false,
            Stage::Ended | Stage::Finalised => true,
        }
    }

    /// Returns the rest of the window [s]; 0 after the end.
    #[must_use]
    pub fn max_time_step_size(&self) -> f64 {
        match &self.stage {
            Stage::Coupling(progress) => progress.rest(),
            _ => 0.0,
        }
    }

    /// Returns true if the program has to give initial data.
    pub fn requires_initial_data(&mut self) -> bool {
        std::mem::take(&mut self.initial_data)
    }

    /// Returns true once at the start of each window. Any window may have to be solved again.
    ///
    /// # Errors
    /// Fails outside of the coupling.
    pub fn requires_writing_checkpoint(&mut self) -> Result<bool, CallError> {
        if self.stage == Stage::Ended {
            return Ok(false);
        }
        let progress = self.coupling()?;
        let fresh = progress.done == 0.0 && !progress.saved;
        progress.saved |= fresh;
        Ok(fresh)
    }

    /// Returns true once after an advance if the window has to be solved again.
    ///
    /// # Errors
    /// Fails outside of the coupling.
    pub fn requires_reading_checkpoint(&mut self) -> Result<bool, CallError> {
        if self.stage == Stage::Ended {
            return Ok(false);
        }
        Ok(std::mem::take(&mut self.coupling()?.must_go_back))
    }

    /// Returns the number of coordinates of a vertex; also for meshes received from others.
    ///
    /// # Errors
    /// Fails for an unknown mesh.
    pub fn mesh_dimensions(&self, mesh: &str) -> Result<usize, CallError> {
        let all = self.interface.meshes.iter().chain(&self.interface.received);
        let mut found = all.filter(|info| info.name == mesh);
        found.next().map(|info| info.dimensions).ok_or_else(|| self.unknown_mesh(mesh))
    }

    /// Returns the number of components of data.
    ///
    /// # Errors
    /// Fails for an unknown mesh or unknown data.
    pub fn data_dimensions(&self, mesh: &str, data: &str) -> Result<usize, CallError> {
        let place = self.mesh(mesh)?;
        let all = self.interface.read.iter().chain(&self.interface.written);
        let mut found = all.filter(|info| info.mesh == place && info.name == data);
        let known = || self.names("read or written", place);
        found.next().map(|info| info.components).ok_or_else(|| CallError::UnknownData {
            mesh: mesh.to_owned(),
            data: data.to_owned(),
            direction: "read or written",
            known: known(),
        })
    }

    /// Returns true if a mapping of the configuration uses the connectivity of a mesh.
    ///
    /// # Errors
    /// Fails for an unknown mesh.
    pub fn requires_mesh_connectivity(&self, mesh: &str) -> Result<bool, CallError> {
        self.own_mesh(mesh).map(|mesh| mesh.info.connected)
    }

    /// Returns a mesh of the program.
    ///
    /// # Errors
    /// Fails for an unknown mesh.
    pub(super) fn own_mesh(&self, mesh: &str) -> Result<&OwnMesh, CallError> {
        self.mesh(mesh).map(|place| &self.meshes[place])
    }

    /// Returns a mesh of the program, to set its vertices and connectivity.
    ///
    /// # Errors
    /// Fails for an unknown mesh, or after initialize.
    pub(super) fn open_mesh(&mut self, mesh: &str) -> Result<&mut OwnMesh, CallError> {
        self.must_be_created("after initialize: the mesh is fixed")?;
        self.mesh(mesh).map(|place| &mut self.meshes[place])
    }

    /// Writes values at vertices, all components of a vertex together.
    ///
    /// # Errors
    /// Fails for unknown data or vertices, a value that is not finite, or outside of the coupling.
    pub fn write(
        &mut self,
        mesh: &str,
        data: &str,
        ids: &[i32],
        values: &[f64],
    ) -> Result<(), CallError> {
        match self.stage {
            Stage::Created | Stage::Ended => {}
            _ => self.coupling().map(|_| ())?,
        }
        let at = self.find(mesh, data, "written")?;
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(CallError::NotFinite { what: "value", index, value: values[index] });
        }
        self.make_room(at);
        let mesh = &self.meshes[self.interface.written[at].mesh];
        let into = &mut self.written[at];
        let (points, components) = (mesh.size(), self.interface.written[at].components);
        for (&id, vertex) in ids.iter().zip(values.chunks_exact(components)) {
            let point = mesh.vertex(id)?;
            for (component, &value) in vertex.iter().enumerate() {
                into[component * points + point] = value;
            }
        }
        Ok(())
    }

    /// Reads values at vertices at a time after the program's last step [s]. Within the window they
    /// are linear in time if the coupling interpolates, and constant otherwise. After the end the
    /// time can only be 0: the values are those at the end of the last window.
    ///
    /// # Errors
    /// Fails for unknown data or vertices, a time outside of the window, or outside of the
    /// coupling.
    pub fn read(
        &mut self,
        mesh: &str,
        data: &str,
        ids: &[i32],
        time: f64,
        values: &mut [f64],
    ) -> Result<(), CallError> {
        let at = self.find(mesh, data, "read")?;
        let share = self.share(time)?;
        let Samples { start, end } = &self.read[at];
        let mesh = &self.meshes[self.interface.read[at].mesh];
        let (points, components) = (mesh.size(), self.interface.read[at].components);
        for (&id, vertex) in ids.iter().zip(values.chunks_exact_mut(components)) {
            let point = mesh.vertex(id)?;
            for (component, value) in vertex.iter_mut().enumerate() {
                let index = component * points + point;
                *value = match start.get(index) {
                    Some(start) => start + share * (end[index] - start),
                    None => end[index],
                };
            }
        }
        Ok(())
    }

    /// Returns the share of the window that has passed at a time after the last step.
    fn share(&mut self, time: f64) -> Result<f64, CallError> {
        if self.stage == Stage::Ended && time == 0.0 {
            return Ok(1.0);
        }
        let progress = self.coupling()?;
        let most = progress.rest();
        match time >= 0.0 && time <= most + ROUNDING * progress.length {
            true => Ok((progress.done + time) / progress.length),
            false => Err(CallError::Time { time, most }),
        }
    }

    fn mesh(&self, name: &str) -> Result<usize, CallError> {
        let found = self.meshes.iter().position(|mesh| mesh.info.name == name);
        found.ok_or_else(|| self.unknown_mesh(name))
    }

    fn unknown_mesh(&self, name: &str) -> CallError {
        let is_received = self.interface.received.iter().any(|info| info.name == name);
        if is_received {
            return CallError::Unsupported {
                what: "access to a received mesh",
                fix: "read and write on a mesh of the program; the coordinator maps the data",
            };
        }
        let names = |meshes: &[MeshInfo]| {
            meshes.iter().map(|mesh| mesh.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        CallError::UnknownMesh { name: name.to_owned(), known: names(&self.interface.meshes) }
    }

    fn find(&self, mesh: &str, data: &str, direction: &'static str) -> Result<usize, CallError> {
        let place = self.mesh(mesh)?;
        let list = match direction {
            "read" => &self.interface.read,
            _ => &self.interface.written,
        };
        let found = list.iter().position(|info| info.mesh == place && info.name == data);
        found.ok_or_else(|| CallError::UnknownData {
            mesh: mesh.to_owned(),
            data: data.to_owned(),
            direction,
            known: self.names(direction, place),
        })
    }

    fn names(&self, direction: &str, mesh: usize) -> String {
        let Interface { read, written, .. } = &self.interface;
        let lists: [&[DataInfo]; 2] = match direction {
            "read" => [read, &[]],
            "written" => [&[], written],
            _ => [read, written],
        };
        let here = lists.into_iter().flatten().filter(|info| info.mesh == mesh);
        let names: Vec<&str> = here.map(|info| info.name.as_str()).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    }
}

/// Checks that every value of the window is written.
fn check_written(data: &DataInfo, mesh: &OwnMesh, values: &[f64]) -> Result<(), CallError> {
    match values.iter().position(|value| value.is_nan()) {
        None if values.len() == data.components * mesh.size() => Ok(()),
        index => Err(CallError::NotWritten {
            mesh: mesh.info.name.clone(),
            data: data.name.clone(),
            vertex: index.unwrap_or(0) % mesh.size().max(1),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::thread::JoinHandle;

    /// A participant with one mesh of two vertices, and a launcher that gives these answers after
    /// the interface. The launcher returns the requests.
    fn participant(answers: Vec<Answer>) -> (Participant, JoinHandle<Vec<Request>>) {
        let (program, mut launcher) = UnixStream::pair().unwrap();
        let data = |name: &str, initial| DataInfo {
            mesh: 0,
            name: name.to_owned(),
            components: 2,
            initial,
        };
        let mesh = |name: &str| MeshInfo { name: name.to_owned(), dimensions: 2, connected: false };
        let interface = Interface {
            meshes: vec![mesh("Wall")],
            received: vec![mesh("Air")],
            read: vec![data("Force", false)],
            written: vec![data("Motion", true)],
        };
        let launcher = std::thread::spawn(move || {
            let (mut requests, mut buffer) = (Vec::new(), Vec::new());
            for answer in std::iter::once(Answer::Interface(interface)).chain(answers) {
                let Ok(request) = protocol::receive(&mut launcher, &mut buffer) else { break };
                requests.push(request);
                protocol::send(&mut launcher, &answer, &mut buffer).unwrap();
            }
            while let Ok(request) = protocol::receive(&mut launcher, &mut buffer) {
                requests.push(request);
            }
            requests
        });
        let mut participant = Participant::over(program, "Solid").unwrap();
        let mesh = participant.open_mesh("Wall").unwrap();
        mesh.add_vertices(&[0.0, 0.0, 1.0, 0.0]).unwrap();
        (participant, launcher)
    }

    fn window(repeats: bool, starts: &[f64], ends: &[f64]) -> Answer {
        Answer::Window(Window {
            length: 0.5,
            repeats,
            starts: vec![starts.to_vec()],
            ends: vec![ends.to_vec()],
        })
    }

    const ENDS: [f64; 4] = [1.0, 2.0, 3.0, 4.0];
    const IDS: [i32; 2] = [0, 1];

    fn write(participant: &mut Participant, values: &[f64]) {
        participant.write("Wall", "Motion", &IDS, values).unwrap();
    }

    fn read(participant: &mut Participant, time: f64) -> [f64; 4] {
        let mut values = [0.0; 4];
        participant.read("Wall", "Force", &IDS, time, &mut values).unwrap();
        values
    }

    #[test]
    fn a_window_is_filled_repeated_and_accepted() {
        let answers = vec![
            window(false, &[], &ENDS),
            window(true, &[], &ENDS),
            window(false, &[0.0; 4], &ENDS),
            Answer::Ended,
        ];
        let (mut program, launcher) = participant(answers);
        assert!(program.requires_initial_data() && !program.requires_initial_data());
        write(&mut program, &[1.0, -1.0, 2.0, -2.0]);
        program.initialize().unwrap();
        // All components of a vertex stand together.
        assert_eq!(read(&mut program, 0.0), [1.0, 3.0, 2.0, 4.0]);
        assert!(program.requires_writing_checkpoint().unwrap());
        assert!(!program.requires_writing_checkpoint().unwrap());
        program.advance(0.2).unwrap();
        assert!((program.max_time_step_size() - 0.3).abs() < 1e-15);
        assert!(!program.is_time_window_complete());
        write(&mut program, &[5.0; 4]);
        program.advance(0.3).unwrap();

        assert!(!program.is_time_window_complete());
        assert!(!program.requires_writing_checkpoint().unwrap());
        assert!(program.requires_reading_checkpoint().unwrap());
        assert!(!program.requires_reading_checkpoint().unwrap());
        write(&mut program, &[6.0; 4]);
        program.advance(0.5).unwrap();

        assert!(program.is_time_window_complete() && program.is_coupling_ongoing());
        assert!(!program.requires_reading_checkpoint().unwrap());
        program.advance(0.25).unwrap();
        // Linear within the window, counted from the program's last step.
        assert_eq!(read(&mut program, 0.0), [0.5, 1.5, 1.0, 2.0]);
        assert_eq!(read(&mut program, 0.25), [1.0, 3.0, 2.0, 4.0]);
        write(&mut program, &[7.0; 4]);
        program.advance(0.25).unwrap();

        assert!(!program.is_coupling_ongoing() && program.is_time_window_complete());
        assert_eq!(program.max_time_step_size(), 0.0);
        // The values at the end of the last window.
        assert_eq!(read(&mut program, 0.0), [1.0, 3.0, 2.0, 4.0]);
        let late = program.read("Wall", "Force", &IDS, 0.1, &mut [0.0; 4]).unwrap_err();
        assert!(late.to_string().contains("after the coupling has ended"), "{late}");
        program.finalize().unwrap();
        assert!(program.read("Wall", "Force", &IDS, 0.0, &mut [0.0; 4]).is_err());
        drop(program);
        let requests = launcher.join().unwrap();
        let Request::Initialise { meshes, values } = &requests[1] else { panic!("{requests:?}") };
        assert_eq!(meshes[0].points, [[0.0; 3], [1.0, 0.0, 0.0]]);
        assert_eq!(*values, [vec![1.0, 2.0, -1.0, -2.0]]);
        assert_eq!(requests[2], Request::Advance { values: vec![vec![5.0; 4]], steps: 2 });
        assert_eq!(requests[3], Request::Advance { values: vec![vec![6.0; 4]], steps: 1 });
        assert_eq!(requests.len(), 5);
    }

    #[test]
    fn a_program_without_checkpoints_cannot_repeat_a_window() {
        let (mut program, _launcher) =
            participant(vec![window(false, &[], &ENDS), window(true, &[], &ENDS)]);
        write(&mut program, &[0.0; 4]);
        program.initialize().unwrap();
        write(&mut program, &[0.0; 4]);
        assert!(matches!(program.advance(0.5), Err(CallError::NoCheckpoint)));
    }

    #[test]
    fn every_value_of_a_window_must_be_written() {
        let (mut program, _launcher) = participant(vec![window(false, &[], &ENDS)]);
        let refused = program.initialize().unwrap_err().to_string();
        assert!(
            refused.contains("`Motion` of mesh `Wall` was not written at vertex 0"),
            "{refused}"
        );
        write(&mut program, &[0.0; 4]);
        program.initialize().unwrap();
        program.write("Wall", "Motion", &[0], &[1.0, 1.0]).unwrap();
        let refused = program.advance(0.5).unwrap_err();
        assert!(matches!(refused, CallError::NotWritten { vertex: 1, .. }), "{refused}");
    }

    #[test]
    fn names_that_do_not_exist_are_refused_with_those_that_do() {
        let (mut program, _launcher) = participant(Vec::new());
        assert_eq!(program.mesh_dimensions("Air").unwrap(), 2);
        let text = |error: CallError| error.to_string();
        let mesh = text(program.mesh_dimensions("Roof").unwrap_err());
        assert!(mesh.contains("it provides: Wall"), "{mesh}");
        let received = text(program.write("Air", "Motion", &[], &[]).unwrap_err());
        assert!(received.contains("access to a received mesh"), "{received}");
        let data = text(program.write("Wall", "Force", &[], &[]).unwrap_err());
        assert!(
            data.contains("is not written on mesh `Wall`") && data.contains("Motion"),
            "{data}"
        );
        assert_eq!(program.data_dimensions("Wall", "Force").unwrap(), 2);
    }

    #[test]
    fn a_lost_launcher_is_an_error() {
        let (mut program, launcher) = participant(Vec::new());
        write(&mut program, &[0.0; 4]);
        program.connection.shutdown(std::net::Shutdown::Both).unwrap();
        assert!(matches!(program.initialize(), Err(CallError::Link(_))));
        launcher.join().unwrap();
    }
}
