//! What slow, many and greedy clients get: nothing that others need.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    io::{Read, Write},
    net::TcpStream,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use ferntast_console::{
    Listen, Server,
    server::Content,
    session::{SharedSession, message::Request},
};
use ferntast_msgs::Time;

struct Page {
    _server: Server,
    address: String,
    shared: Arc<SharedSession>,
}

fn serve(folder: &Path) -> Page {
    let time = Box::new(|| Time::from_nanos(1_000_000_000));
    let shared = Arc::new(SharedSession::new(serde_json::Value::Null, time));
    let content = Content {
        shared: Some(shared.clone()),
        folder: folder.to_owned(),
    };
    let listen = Listen {
        address: Some("127.0.0.1:0".parse().unwrap()),
        token: None,
    };
    let server = Server::start(&listen, content).unwrap();
    let address = server.url.strip_prefix("http://").unwrap().to_owned();
    Page {
        _server: server,
        address,
        shared,
    }
}

impl Page {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.address).unwrap();
        let patience = Some(Duration::from_secs(30));
        stream.set_read_timeout(patience).unwrap();
        stream
    }

    /// Asks, and gives what comes back until the end of the connection.
    fn ask(&self, request: &str, body: &str) -> String {
        let mut stream = self.connect();
        let text = format!(
            "{request} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n{body}",
            self.address
        );
        stream.write_all(text.as_bytes()).unwrap();
        let mut answer = Vec::new();
        // What was not read of the request may end it with a reset.
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// A page that is open: its WebSocket, behind what is said at first.
    fn open_page(&self) -> TcpStream {
        let mut stream = self.connect();
        let text = format!(
            "GET /api/session HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
            self.address
        );
        stream.write_all(text.as_bytes()).unwrap();
        assert!(read_until(&mut stream, "hello").starts_with("HTTP/1.1 101"));
        stream
    }
}

/// Reads until `words` have come.
fn read_until(stream: &mut TcpStream, words: &str) -> String {
    let mut read = String::new();
    let mut bytes = [0; 1024];
    while !read.contains(words) {
        let count = stream.read(&mut bytes).unwrap();
        assert!(count > 0, "closed behind {read:?}");
        read.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
    read
}

/// A masked text frame of a WebSocket.
fn text_frame(text: &str) -> Vec<u8> {
    let length = u8::try_from(text.len()).unwrap();
    assert!(length < 126);
    let mut frame = vec![0x81, 0x80 | length, 0, 0, 0, 0];
    frame.extend_from_slice(text.as_bytes());
    frame
}

#[test]
fn a_thousand_slow_connections_keep_nobody_from_the_page_and_its_stop() {
    let folder = tempfile::tempdir().unwrap();
    let page = serve(folder.path());
    let mut operator = page.open_page();
    let mut slow = Vec::new();
    for _ in 0..1000 {
        let mut stream = page.connect();
        // A part of a request, and then nothing.
        let _ = stream.write_all(b"GET / HTTP/1.1\r\nHost: ");
        slow.push(stream);
        // The test has descriptors for both ends of some hundred.
        if slow.len() > 300 {
            slow.remove(0);
        }
    }
    let begun = Instant::now();
    assert!(page.ask("GET /", "\r\n").starts_with("HTTP/1.1 200"));
    assert!(
        begun.elapsed() < Duration::from_secs(2),
        "{:?}",
        begun.elapsed()
    );
    // The page that was open is, and is heard.
    page.shared.show("\"a snapshot\"".to_owned());
    read_until(&mut operator, "a snapshot");
    let stop = "{\"type\":\"state\",\"word\":\"stop\"}";
    operator.write_all(&text_frame(stop)).unwrap();
    let begun = Instant::now();
    let mut wishes = page.shared.wishes();
    while wishes.is_empty() && begun.elapsed() < Duration::from_secs(5) {
        wishes = page.shared.wishes();
    }
    assert!(
        matches!(wishes.front(), Some(Request::State { .. })),
        "{wishes:?}"
    );
    // Another page gets in, too.
    drop(page.open_page());
    // Those that say nothing more are closed.
    let begun = Instant::now();
    let mut last = slow.pop().unwrap();
    let mut byte = [0];
    while matches!(last.read(&mut byte), Ok(1..)) {}
    assert!(
        begun.elapsed() < Duration::from_secs(15),
        "{:?}",
        begun.elapsed()
    );
}

#[test]
fn pages_beyond_the_most_take_the_place_of_the_oldest_watcher() {
    let folder = tempfile::tempdir().unwrap();
    let page = serve(folder.path());
    let mut first = page.open_page();
    let others: Vec<TcpStream> = (0..40).map(|_| page.open_page()).collect();
    assert!(page.shared.pages() <= 32, "{}", page.shared.pages());
    let mut rest = Vec::new();
    assert!(first.read_to_end(&mut rest).is_ok(), "the oldest is closed");
    drop(others);
}

#[test]
fn a_recording_that_is_too_large_is_refused_in_words_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let page = serve(folder.path());
    let upload = "POST /api/lab/upload?name=big.csv";
    let answer = page.ask(upload, "Content-Length: 3000000000\r\n\r\nt_s,q\n");
    assert!(answer.starts_with("HTTP/1.1 413"), "{answer}");
    assert!(answer.contains("more than 2 GiB"), "{answer}");
    // One that is cut off leaves nothing either.
    let mut stream = page.connect();
    let text = format!(
        "{upload} HTTP/1.1\r\nHost: {}\r\nContent-Length: 1000\r\n\r\nt_s,q\n",
        page.address
    );
    stream.write_all(text.as_bytes()).unwrap();
    let files = || std::fs::read_dir(folder.path()).unwrap().count();
    let wait_for = |wanted: usize| {
        let begun = Instant::now();
        while files() != wanted && begun.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(20));
        }
        assert_eq!(files(), wanted);
    };
    wait_for(1);
    drop(stream);
    wait_for(0);
    // What arrives whole is taken.
    let answer = page.ask(upload, "Content-Length: 11\r\n\r\nt_s,q\n0,1\n\n");
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
}

#[test]
fn a_request_that_is_too_long_or_too_slow_is_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let page = serve(folder.path());
    let compare = "POST /api/lab/compare";
    let long = page.ask(compare, "Content-Length: 2000000\r\n\r\n{");
    assert!(long.starts_with("HTTP/1.1 413"), "{long}");
    let begun = Instant::now();
    let slow = page.ask(compare, "Content-Length: 100\r\n\r\n{");
    assert!(slow.starts_with("HTTP/1.1 408"), "{slow}");
    assert!(slow.contains("did not arrive whole"), "{slow}");
    assert!(
        begun.elapsed() < Duration::from_secs(20),
        "{:?}",
        begun.elapsed()
    );
}
