//! Proxy between a client and a server that does what networks and overloaded servers do.

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread;
use std::time::Duration;

/// Treatment of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Behaviour {
    /// It is passed on, and so is its answer.
    Pass,
    /// It is answered with a status and its reason, and a body.
    Refuse(&'static str, &'static str),
    /// It is passed on and so is its answer, each piece of up to 64 KiB so much later.
    #[allow(dead_code, reason = "not all that use this module are in no hurry")]
    Delay(Duration),
    /// Once so many bytes of requests were passed on, no more are.
    StallAfter(u64),
    /// The next request that has this text in its head is passed on, and the connection ends when its answer comes.
    LoseAnswerTo(&'static str),
}

/// A TCP proxy before a server of this machine.
pub(crate) struct Proxy {
    address: String,
    shared: Arc<Shared>,
}

struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    behaviour: Behaviour,
    /// Bytes of requests that were passed on.
    passed: u64,
    /// Requests that were not answered by the server, or whose answers were lost.
    disturbed: u64,
}

impl Proxy {
    /// Stands before the server at an address. It ends with the process.
    pub(crate) fn before(server: &str) -> Proxy {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("its address").to_string();
        let state = State { behaviour: Behaviour::Pass, passed: 0, disturbed: 0 };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let (accepting, server) = (shared.clone(), server.to_owned());
        thread::spawn(move || {
            for client in listener.incoming().flatten() {
                let (shared, server) = (accepting.clone(), server.clone());
                thread::spawn(move || serve(&client, &server, &shared));
            }
        });
        Proxy { address, shared }
    }

    /// Address for clients.
    pub(crate) fn address(&self) -> &str {
        &self.address
    }

    /// Sets the behaviour from now on.
    pub(crate) fn set(&self, behaviour: Behaviour) {
        self.shared.state.lock().expect("no thread panics").behaviour = behaviour;
        self.shared.changed.notify_all();
    }

    /// Waits until so many bytes of requests were passed on.
    pub(crate) fn wait_for(&self, bytes: u64) {
        let state = self.shared.state.lock().expect("no thread panics");
        drop(self.shared.changed.wait_while(state, |state| state.passed < bytes));
    }

    /// Bytes of requests that were passed on.
    #[allow(dead_code, reason = "not all that use this module count them")]
    pub(crate) fn passed(&self) -> u64 {
        self.shared.state.lock().expect("no thread panics").passed
    }

    /// Waits until so many requests were disturbed.
    pub(crate) fn wait_for_disturbed(&self, requests: u64) {
        let state = self.shared.state.lock().expect("no thread panics");
        drop(self.shared.changed.wait_while(state, |state| state.disturbed < requests));
    }

    /// Requests that were disturbed.
    pub(crate) fn disturbed(&self) -> u64 {
        self.shared.state.lock().expect("no thread panics").disturbed
    }
}

/// Passes requests on, and has another thread pass their answers back. Whatever fails ends both connections.
fn serve(client: &TcpStream, address: &str, shared: &Arc<Shared>) {
    let Ok(server) = TcpStream::connect(address) else {
        return;
    };
    let is_lost = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| {
            answer(&server, client, &is_lost, shared);
            end(client, &server);
        });
        ask(client, &server, &is_lost, shared);
        end(client, &server);
    });
}

fn end(client: &TcpStream, server: &TcpStream) {
    // One that is ended already is no matter.
    let _ = client.shutdown(Shutdown::Both);
    let _ = server.shutdown(Shutdown::Both);
}

fn ask(mut client: &TcpStream, mut server: &TcpStream, is_lost: &AtomicBool, shared: &Shared) {
    let mut buffer = vec![0; 64 << 10];
    while let Ok(length @ 1..) = client.read(&mut buffer) {
        let bytes = &buffer[..length];
        let state = shared.state.lock().expect("no thread panics");
        let is_stalled = |state: &mut State| matches!(state.behaviour, Behaviour::StallAfter(bytes) if state.passed >= bytes);
        let mut state = shared.changed.wait_while(state, is_stalled).expect("no thread panics");
        match state.behaviour {
            Behaviour::Refuse(status, body) => {
                state.disturbed += 1;
                shared.changed.notify_all();
                let length = body.len();
                let head =
                    format!("HTTP/1.1 {status}\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n");
                let _ = client.write_all(format!("{head}{body}").as_bytes());
                return;
            }
            Behaviour::LoseAnswerTo(text)
                if bytes.windows(text.len()).any(|part| part == text.as_bytes()) =>
            {
                state.behaviour = Behaviour::Pass;
                is_lost.store(true, Ordering::SeqCst);
            }
            _ => {}
        }
        state.passed += length as u64;
        shared.changed.notify_all();
        drop(state);
        shared.delay();
        if server.write_all(bytes).is_err() {
            return;
        }
    }
}

fn answer(mut server: &TcpStream, mut client: &TcpStream, is_lost: &AtomicBool, shared: &Shared) {
    let mut buffer = vec![0; 64 << 10];
    while let Ok(length @ 1..) = server.read(&mut buffer) {
        if is_lost.load(Ordering::SeqCst) {
            shared.state.lock().expect("no thread panics").disturbed += 1;
            shared.changed.notify_all();
            return;
        }
        shared.delay();
        if client.write_all(&buffer[..length]).is_err() {
            return;
        }
    }
}

impl Shared {
    /// Waits for as long as a piece takes now.
    fn delay(&self) {
        let behaviour = self.state.lock().expect("no thread panics").behaviour;
        if let Behaviour::Delay(time) = behaviour {
            thread::sleep(time);
        }
    }
}
