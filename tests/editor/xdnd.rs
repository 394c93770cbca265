//! A file dropped on a window, as a file manager does it: the source of the XDND protocol, version 5
//! (<https://www.freedesktop.org/wiki/Specifications/XDND/>), with one type and one file.

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    ClientMessageEvent, ConnectionExt, CreateWindowAux, EventMask, PropMode, SELECTION_NOTIFY_EVENT,
    SelectionNotifyEvent, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;
use x11rb::{COPY_DEPTH_FROM_PARENT, COPY_FROM_PARENT, CURRENT_TIME};

/// Drops a file on a window, and waits until the window says that it has it.
pub fn drop_file(display: &str, target: u32, path: &Path) {
    let (connection, screen) = x11rb::connect(Some(display)).unwrap();
    let root = connection.setup().roots[screen].root;
    let source = connection.generate_id().unwrap();
    let (depth, class, visual) = (COPY_DEPTH_FROM_PARENT, WindowClass::INPUT_OUTPUT, COPY_FROM_PARENT);
    let look = CreateWindowAux::new();
    connection.create_window(depth, source, root, 0, 0, 1, 1, 0, class, visual, &look).unwrap();
    let atom = |name: &str| connection.intern_atom(false, name.as_bytes()).unwrap().reply().unwrap().atom;
    let [uri_list, copy, finished] = ["text/uri-list", "XdndActionCopy", "XdndFinished"].map(atom);
    connection.set_selection_owner(source, atom("XdndSelection"), CURRENT_TIME).unwrap();
    let send = |name: &str, data: [u32; 5]| {
        let event = ClientMessageEvent::new(32, target, atom(name), data);
        connection.send_event(false, target, EventMask::NO_EVENT, event).unwrap();
        connection.flush().unwrap();
    };
    send("XdndEnter", [source, 5 << 24, uri_list, 0, 0]);
    send("XdndPosition", [source, 0, 640 << 16 | 400, CURRENT_TIME, copy]);
    loop {
        match next_event(&connection) {
            Event::SelectionRequest(asked) => {
                let uri = format!("file://{}\r\n", path.display());
                let (to, property) = (asked.requestor, asked.property);
                connection
                    .change_property8(PropMode::REPLACE, to, property, asked.target, uri.as_bytes())
                    .unwrap();
                let answer = SelectionNotifyEvent {
                    response_type: SELECTION_NOTIFY_EVENT,
                    sequence: 0,
                    time: asked.time,
                    requestor: to,
                    selection: asked.selection,
                    target: asked.target,
                    property,
                };
                connection.send_event(false, to, EventMask::NO_EVENT, answer).unwrap();
                send("XdndDrop", [source, 0, CURRENT_TIME, 0, 0]);
            }
            Event::ClientMessage(message) if message.type_ == finished => return,
            _ => {}
        }
    }
}

fn next_event(connection: &RustConnection) -> Event {
    let start = Instant::now();
    loop {
        if let Some(event) = connection.poll_for_event().unwrap() {
            return event;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "the window does not take the drop");
        std::thread::sleep(Duration::from_millis(10));
    }
}
