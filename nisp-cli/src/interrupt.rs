//! Ctrl-C and SIGTERM: once to stop at the best state, twice to stop at once.
//!
//! Stopping at the best state takes a step's time and the answer's. Where they take too long, the program ends all the same:
//! what a later run can go on from is written first.

use std::path::PathBuf;
use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{Builder, park, sleep};
use std::time::{Duration, Instant};

use nisp::Checkpoint;
use nisp_data::atomic::write_atomic;
use nisp_data::out_dir::Traces;

use crate::terminal::{NOT_CONVERGED, note};

/// What a shell reports of a process that SIGINT ended.
const KILLED: i32 = 130;
/// From the first signal to the end at the latest: less than the ten seconds after which others send SIGKILL.
const GRACE: Duration = Duration::from_secs(8);
/// A set of files that is being put into place is waited for this much longer.
const WRITING: Duration = Duration::from_secs(1);

static ASKED: AtomicBool = AtomicBool::new(false);
static LEAVING: Mutex<Leaving> = Mutex::new(Leaving { traces: None, reached: Reached::Nothing });
static PLACING: Mutex<()> = Mutex::new(());

/// What to see to if the program must end before the run does.
struct Leaving {
    traces: Option<Traces>,
    reached: Reached,
}

/// What a run has come to.
enum Reached {
    Nothing,
    /// What a later run can go on from, and the file for it.
    State(PathBuf, Checkpoint),
    /// All of it, in this folder.
    Answer(PathBuf),
}

/// Begins to listen, in the name of a program. Before that a signal ends the program as it ends any other.
///
/// # Errors
/// The system does not let it.
pub fn listen(program: &'static str) -> Result<(), String> {
    let watch = Builder::new().name("watch".into()).spawn(move || watch(program));
    let watch = watch.map_err(|error| format!("cannot start a thread: {error}"))?.thread().clone();
    let heard = ctrlc::set_handler(move || {
        if ASKED.swap(true, Ordering::Relaxed) {
            exit(KILLED);
        }
        watch.unpark();
        say(format!("\n{program}: stopping at the best state so far; once more to stop at once\n"));
    });
    heard.map_err(|error| format!("cannot listen for Ctrl-C: {error}"))
}

/// Whether the user has asked to stop.
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}

/// An error where the user has asked to stop: what was cut short is no measurement.
///
/// # Errors
/// The user has asked.
pub fn check() -> Result<(), String> {
    if asked() { Err("interrupted; nothing was written".into()) } else { Ok(()) }
}

/// What must go if the program ends early.
pub fn clean(traces: Traces) {
    lock(&LEAVING).traces = Some(traces);
}

/// What is to be written to a path if the program ends early.
pub fn keep(path: PathBuf, checkpoint: Checkpoint) {
    lock(&LEAVING).reached = Reached::State(path, checkpoint);
}

/// The answer is written: there is nothing more to keep.
pub fn kept(folder: PathBuf) {
    lock(&LEAVING).reached = Reached::Answer(folder);
}

/// Puts files into their places, which the program waits for before it ends early.
pub fn placing<T>(put: impl FnOnce() -> T) -> T {
    let _whole = lock(&PLACING);
    put()
}

/// Waits for the first signal, and then not for ever.
fn watch(program: &str) {
    while !asked() {
        park();
    }
    sleep(GRACE);
    let late = Instant::now() + WRITING;
    let _whole = loop {
        match PLACING.try_lock() {
            Err(TryLockError::WouldBlock) if Instant::now() < late => sleep(Duration::from_millis(10)),
            held => break held,
        }
    };
    leave(program)
}

fn leave(program: &str) -> ! {
    let mut leaving = lock(&LEAVING);
    let seconds = GRACE.as_secs();
    let words = match std::mem::replace(&mut leaving.reached, Reached::Nothing) {
        Reached::Nothing => format!("no state was reached within {seconds} s"),
        Reached::Answer(folder) => format!("the results are in {}", folder.display()),
        Reached::State(path, checkpoint) => match write_atomic(&path, |out| out.write_all(&checkpoint.to_bytes())) {
            Ok(()) => format!(
                "the answer takes more than {seconds} s, and the state is in {}: --resume goes on from it",
                path.display()
            ),
            Err(error) => error.to_string(),
        },
    };
    if let Some(traces) = leaving.traces.take() {
        traces.remove();
    }
    say(format!("{program}: interrupted; {words}\n"));
    exit(NOT_CONVERGED.into())
}

/// Time that words may take to get out.
const WORDS: Duration = Duration::from_millis(200);

/// Tells the user, without waiting for a standard error that nobody reads.
fn say(text: String) {
    let (sender, said) = channel();
    let speaker = Builder::new().spawn(move || {
        note(&text);
        sender.send(())
    });
    if speaker.is_ok() {
        let _ = said.recv_timeout(WORDS);
    }
}

/// A panic elsewhere spoils nothing of what these hold.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
