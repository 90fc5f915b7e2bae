use super::*;
use crate::fault::{COSIM_FAILED, COSIM_OK, cosim_fail, cosim_refuse};
use crate::fields::{cosim_blob_read, cosim_blob_write, cosim_output};
use crate::solver::{COSIM_VERSION, empty};
use proto::model::InputField;
use proto::progress::Progress;
use std::ffi::{c_char, c_int};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null;

/// Stand-in for a C program: a counter that can be told to misbehave.
#[derive(Default)]
struct Counter {
    fault: &'static str,
    trial: u64,
    accepted: u64,
    finished: u32,
    destroyed: u32,
}

const DESCRIPTION: &std::ffi::CStr = c"{\"name\": \"counter\", \"version\": \"1\", \"role\": \
    \"counter\", \"models\": [{\"name\": \"count\", \"summary\": \"\", \"source\": \"\", \
    \"steady\": true, \"transient\": true, \"provides\": [\"number\"]}], \"fields\": [{\"name\": \
    \"number\", \"unit\": \"1\", \"components\": 1, \"mapping\": \"consistent\", \"body\": \
    \"interface\", \"meaning\": \"the count\"}]}";

unsafe fn counter<'a>(user: *mut c_void) -> &'a mut Counter {
    unsafe { &mut *user.cast::<Counter>() }
}

unsafe fn failing(user: *mut c_void, name: &str) -> c_int {
    if unsafe { counter(user) }.fault != name {
        return COSIM_OK;
    }
    unsafe { cosim_fail(c"told to fail".as_ptr()) }
}

unsafe extern "C" fn describe(user: *mut c_void) -> *const c_char {
    match unsafe { counter(user) }.fault {
        "describe" => null(),
        "description" => c"{\"name\": 3".as_ptr(),
        _ => DESCRIPTION.as_ptr(),
    }
}

unsafe extern "C" fn configure(
    user: *mut c_void,
    _: *const CosimConfiguration<'_>,
    _: *mut CosimLayout,
) -> c_int {
    if unsafe { counter(user) }.fault == "refuse" {
        return unsafe { cosim_refuse(c"a.b".as_ptr(), c"no".as_ptr(), c"yes".as_ptr()) };
    }
    unsafe { failing(user, "configure") }
}

unsafe extern "C" fn build(user: *mut c_void) -> c_int {
    unsafe { failing(user, "build") }
}

unsafe extern "C" fn solve(
    user: *mut c_void,
    step: *const CosimStep,
    _: *const CosimInputs<'_>,
    outputs: *mut CosimOutputs<'_>,
    report: *mut CosimReport,
) -> c_int {
    unsafe {
        let values = cosim_output(outputs, c"number".as_ptr(), std::ptr::null_mut());
        let this = counter(user);
        this.trial = this.accepted + 1;
        *values = this.trial as f64;
        (*report).work = (*step).window;
        failing(user, "solve")
    }
}

unsafe extern "C" fn accept(user: *mut c_void) -> c_int {
    unsafe {
        let this = counter(user);
        this.accepted = this.trial;
        failing(user, "accept")
    }
}

unsafe extern "C" fn write(user: *mut c_void, _: *mut CosimOutputs<'_>) -> c_int {
    unsafe { failing(user, "write") }
}

unsafe extern "C" fn save(user: *mut c_void, blob: *mut CosimBlob<'_>) -> c_int {
    unsafe {
        let accepted = &raw const counter(user).accepted;
        cosim_blob_write(blob, accepted.cast(), 8);
        failing(user, "save")
    }
}

unsafe extern "C" fn restore(user: *mut c_void, blob: *mut CosimBlob<'_>) -> c_int {
    unsafe { cosim_blob_read(blob, (&raw mut counter(user).accepted).cast(), 8) }
}

unsafe extern "C" fn summary(user: *mut c_void) -> *const c_char {
    match unsafe { counter(user) }.fault {
        "summary" => null(),
        "list" => c"[1]".as_ptr(),
        "not-json" => c"{\"x\": nan}".as_ptr(),
        _ => c"{\"counter\": {\"solves\": 1}}".as_ptr(),
    }
}

unsafe extern "C" fn destroy_it(user: *mut c_void) {
    unsafe { counter(user).destroyed += 1 };
}

unsafe extern "C" fn finish(user: *mut c_void) -> c_int {
    unsafe {
        counter(user).finished += 1;
        failing(user, "finish")
    }
}

fn table() -> CosimSolver {
    CosimSolver {
        describe: Some(describe),
        configure: Some(configure),
        build: Some(build),
        first_outputs: Some(write),
        solve: Some(solve),
        accept: Some(accept),
        observe: Some(write),
        save: Some(save),
        restore: Some(restore),
        summary: Some(summary),
        destroy: Some(destroy_it),
        finish: Some(finish),
        ..empty()
    }
}

/// One number, sent.
struct Number(Vec<f64>);

impl Outputs for Number {
    fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]> {
        (field.name == "number").then_some(&mut self.0)
    }
}

struct Nothing;

impl Inputs for Nothing {
    fn get(&self, _: &FieldSpec) -> Option<InputField<'_>> {
        None
    }
}

fn configuration() -> Configuration {
    serde_json::from_value(json!({
        "role": "counter", "model": "count", "mode": "steady", "case": {}, "inputs": [],
        "outputs": ["number"], "observed": [],
    }))
    .unwrap()
}

fn program(counter: &mut Counter, table: CosimSolver) -> Program {
    unsafe { Program::new(table, (&raw mut *counter).cast()) }.unwrap()
}

fn model(program: &Program) -> Box<dyn Model> {
    program.configure(&configuration()).unwrap().build(&Progress::default()).unwrap()
}

#[test]
fn a_description_is_completed() {
    let mut counter = Counter::default();
    let program = program(&mut counter, table());
    let description = program.description();
    assert_eq!(description.protocol, proto::PROTOCOL_VERSION);
    assert!(description.estimates && !description.standalone && description.effects.is_empty());
    assert_eq!(description.models[0].provides, ["number"]);
    drop(program);
    assert_eq!(counter.destroyed, 1);
}

#[test]
fn a_description_that_cannot_be_is_reported_and_the_program_destroyed() {
    for (fault, why) in [("describe", "without a reason"), ("description", "the text of `desc")] {
        let mut counter = Counter { fault, ..Counter::default() };
        let error = unsafe { Program::new(table(), (&raw mut counter).cast()) };
        let error = error.map(|_| ()).unwrap_err();
        assert!(error.contains(why), "{error}");
        assert_eq!(counter.destroyed, 1);
    }
    for text in ["[]", "{}", "{\"name\": \"x\"}"] {
        assert!(described(text).unwrap_err().starts_with("the text of `describe`"));
    }
}

#[test]
fn a_window_is_solved_from_the_accepted_state() {
    let mut counter = Counter::default();
    let program = program(&mut counter, table());
    let mut model = model(&program);
    let mut outputs = Number(vec![9.0]);
    let step = Step { window: 5, ..Step::STEADY };
    for _ in 0..2 {
        let report = model.solve(&step, &Nothing, &mut outputs).unwrap();
        assert_eq!((report.work, report.received_power, outputs.0[0]), (5, None, 1.0));
    }
    model.accept();
    model.solve(&step, &Nothing, &mut outputs).unwrap();
    assert_eq!(outputs.0[0], 2.0);
    let mut state = Vec::new();
    model.save(&mut state).unwrap();
    assert_eq!(state, 1_u64.to_ne_bytes());
    model.accept();
    model.restore(&mut state.as_slice()).unwrap();
    model.solve(&step, &Nothing, &mut outputs).unwrap();
    assert_eq!(outputs.0[0], 2.0);
    let short = model.restore(&mut &state[..7]).unwrap_err();
    assert_eq!(short.to_string(), "state does not fit: it is truncated");
    assert_eq!(model.summary(), json!({"counter": {"solves": 1}}));
}

#[test]
fn faults_become_the_errors_of_the_contract() {
    let mut refusing = Counter { fault: "refuse", ..Counter::default() };
    let refused = program(&mut refusing, table()).configure(&configuration());
    assert_eq!(refused.map(|_| ()).unwrap_err(), Refusal::new("a.b", "no", "yes"));
    let mut counter = Counter { fault: "save", ..Counter::default() };
    let saved = model(&program(&mut counter, table())).save(&mut Vec::new());
    assert_eq!(saved.unwrap_err().to_string(), "told to fail");
    let mut counter = Counter { fault: "solve", ..Counter::default() };
    let program = program(&mut counter, table());
    let solved = model(&program).solve(&Step::STEADY, &Nothing, &mut Number(vec![0.0]));
    assert_eq!(solved, Err(StepError::NoSolution("told to fail".to_owned())));
}

/// The program ends with its last message where the contract has no error.
#[test]
fn faults_without_an_error_unwind_to_main() {
    type Act = fn(&mut dyn Model);
    let acts: [(&'static str, Act, &str); 9] = [
        ("finish", |_| (), "told to fail"),
        ("configure", |_| (), "told to fail"),
        ("build", |_| (), "told to fail"),
        ("write", |m| m.first_outputs(&mut Number(vec![0.0])), "told to fail"),
        ("write", |m| m.observe(&mut Number(vec![0.0])), "told to fail"),
        ("accept", |m| m.accept(), "told to fail"),
        ("summary", |m| drop(m.summary()), "`summary` returned 2 without a reason"),
        ("list", |m| drop(m.summary()), "`summary` is no JSON object: [1]"),
        ("not-json", |m| drop(m.summary()), "`summary` is not JSON"),
    ];
    for (fault, act, why) in acts {
        let mut counter = Counter { fault, ..Counter::default() };
        let program = program(&mut counter, table());
        let acted = catch_unwind(AssertUnwindSafe(|| act(&mut *model(&program))));
        let unwound = acted.unwrap_err();
        let Some(FatalMessage(said)) = unwound.downcast_ref() else { panic!("{fault}") };
        assert!(said.contains(why), "{said}");
    }
}

/// `finish` is called once for each successful build.
#[test]
fn a_run_is_finished_once() {
    let mut counter = Counter::default();
    let program = program(&mut counter, table());
    drop(model(&program));
    drop(model(&program));
    drop(program.configure(&configuration()));
    drop(program);
    assert_eq!((counter.finished, counter.destroyed), (2, 1));
}

#[test]
fn what_is_left_out() {
    let least = CosimSolver {
        build: None,
        first_outputs: None,
        accept: None,
        observe: None,
        save: None,
        restore: None,
        summary: None,
        destroy: None,
        finish: None,
        ..table()
    };
    let mut counter = Counter::default();
    let program = program(&mut counter, least);
    let mut model = model(&program);
    let mut outputs = Number(vec![9.0]);
    model.first_outputs(&mut outputs);
    assert_eq!(outputs.0, [0.0]);
    model.accept();
    model.observe(&mut outputs);
    let mut state = Vec::new();
    model.save(&mut state).unwrap();
    assert!(state.is_empty() && model.restore(&mut state.as_slice()).is_ok());
    assert_eq!(model.summary(), json!({}));
    let observing = Configuration { observed: vec!["number".to_owned()], ..configuration() };
    let refused = program.configure(&observing).map(|_| ()).unwrap_err();
    assert_eq!(refused.key, "output.fields");
}

#[test]
fn main_says_what_is_wrong_with_its_arguments() {
    use crate::cosim_main;
    let mut counter = Counter::default();
    let user = (&raw mut counter).cast::<c_void>();
    let table = table();
    unsafe {
        assert_eq!(cosim_main(0, std::ptr::null_mut(), null(), user), 1);
        let old = CosimSolver { version: COSIM_VERSION + 1, ..table };
        assert_eq!(cosim_main(0, std::ptr::null_mut(), &raw const old, user), 1);
        // Nothing to do, and an unknown option.
        assert_eq!(cosim_main(0, std::ptr::null_mut(), &raw const table, user), 1);
        let mut words = [c"x".as_ptr(), c"--nonsense".as_ptr(), null()].map(<*const _>::cast_mut);
        assert_eq!(cosim_main(2, words.as_mut_ptr(), &raw const table, user), 2);
    }
    assert_eq!((counter.destroyed, COSIM_FAILED), (2, 2));
}
