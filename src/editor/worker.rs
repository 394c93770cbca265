//! The thread that solves: it owns the session, so that the window never waits.
//!
//! A new request cancels the one that runs. Replies carry the number of their request; the window drops
//! those of older ones.

use std::sync::mpsc::{Receiver, Sender, channel};

use crate::gpu::AdapterChoice;
use crate::graph::{CancelToken, Document, Event, Target, Value};
use crate::session::{NodeCost, Session};

/// What the window asks for.
struct Request {
    number: u64,
    document: Document,
    node: String,
    output: String,
    cancel: CancelToken,
}

/// What the worker tells.
pub enum Reply {
    /// A node began, ended, failed or was skipped.
    Event(Event),
    /// The end of a request: the value that was asked for, where it came to be, and what nodes cost.
    Solved {
        /// The output that was asked for.
        value: Option<Value>,
        /// Of each node that ran.
        costs: Vec<NodeCost>,
    },
    /// No device, or it is gone.
    NoDevice(String),
}

/// The window's end of the thread.
pub struct Worker {
    requests: Sender<Request>,
    replies: Receiver<(u64, Reply)>,
    number: u64,
    cancel: CancelToken,
}

impl Worker {
    /// Starts the thread; `wake` is called after each reply.
    pub fn start(adapter: &AdapterChoice, wake: impl Fn() + Send + 'static) -> Self {
        let (requests, to_do) = channel::<Request>();
        let (done, replies) = channel();
        let adapter = adapter.clone();
        std::thread::spawn(move || {
            let tell = |number, reply| {
                // A window that is gone needs no replies.
                let _ = done.send((number, reply));
                wake();
            };
            let mut session = match Session::open(&adapter) {
                Ok(session) => session,
                Err(error) => return tell(0, Reply::NoDevice(error.to_string())),
            };
            for Request { number, document, node, output, cancel } in to_do {
                let solved = session.solve(&document, Target::Nodes(&[&node]), &cancel, &mut |event| {
                    tell(number, Reply::Event(event.clone()));
                });
                let value = solved.evaluation.value(&node, &output).cloned();
                tell(number, Reply::Solved { value, costs: solved.costs });
            }
        });
        Self { requests, replies, number: 0, cancel: CancelToken::new() }
    }

    /// Asks for an output of a node, and cancels what was asked before.
    pub fn solve(&mut self, document: &Document, node: &str, output: &str) {
        self.cancel.cancel();
        self.cancel = CancelToken::new();
        self.number += 1;
        // The thread ends only without a device, which it has told.
        let _ = self.requests.send(Request {
            number: self.number,
            document: document.clone(),
            node: node.to_owned(),
            output: output.to_owned(),
            cancel: self.cancel.clone(),
        });
    }

    /// The replies to the last request that came since the last call.
    pub fn replies(&self) -> Vec<Reply> {
        let new = self.replies.try_iter().filter(|(number, _)| *number == self.number || *number == 0);
        new.map(|(_, reply)| reply).collect()
    }
}
