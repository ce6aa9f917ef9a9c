//! The parameter over DDS.

use std::{
    fmt,
    future::Future,
    pin::pin,
    sync::Arc,
    task::{Context, Poll, Wake, Waker},
    thread::{self, JoinHandle, Thread},
};

use ros2_client::{Node, NodeName, NodeOptions, ParameterValue};

use super::{Choice, Judge};
use crate::{dds::DdsBus, error::OpenError};

/// A node that answers the parameter services in a thread of its own.
pub(super) struct DdsParameter {
    name: String,
    /// Dropped first: that ends the thread.
    node: Option<Node>,
    answering: Option<JoinHandle<()>>,
}

pub(super) fn open(bus: &DdsBus, choice: &Choice, judge: Judge) -> Result<DdsParameter, OpenError> {
    let middleware = |reason: String| OpenError::Middleware {
        transport: "DDS",
        reason: format!("parameters of node {}: {reason}", choice.node),
    };
    let name = NodeName::new("/", &choice.node).map_err(|error| OpenError::BadName {
        what: "node",
        name: choice.node.clone(),
        reason: format!("{error:?}"),
    })?;
    let judge = Arc::new(judge);
    let taker = judge.clone();
    let options = NodeOptions::new()
        .enable_rosout(false)
        .declare_parameter(&choice.name, ParameterValue::String(choice.value.clone()))
        .parameter_validator(Box::new(move |name, value| judge.check(name, text(value))))
        .parameter_set_action(Box::new(move |name, value| taker.take(name, text(value))));
    let mut node = bus
        .context()
        .new_node(name, options)
        .map_err(|error| middleware(error.to_string()))?;
    let spinner = node
        .spinner()
        .map_err(|error| middleware(error.to_string()))?;
    let answering = thread::Builder::new()
        .name("parameters".to_owned())
        .spawn(move || {
            // It ends when the node is dropped; an error ends it too, and then
            // nobody is answered.
            if let Err(error) = run(spinner.spin()) {
                eprintln!("parameters are not served any more: {error}");
            }
        })
        .map_err(|error| middleware(error.to_string()))?;
    Ok(DdsParameter {
        name: choice.name.clone(),
        node: Some(node),
        answering: Some(answering),
    })
}

fn text(value: &ParameterValue) -> Option<&str> {
    match value {
        ParameterValue::String(text) => Some(text),
        _ => None,
    }
}

impl DdsParameter {
    pub(super) fn tell(&mut self, value: &str) -> Result<(), String> {
        match &self.node {
            Some(node) => node.set_parameter(&self.name, ParameterValue::String(value.to_owned())),
            None => Ok(()),
        }
    }
}

impl Drop for DdsParameter {
    fn drop(&mut self) {
        drop(self.node.take());
        if let Some(answering) = self.answering.take() {
            // It has nothing to say.
            let _ = answering.join();
        }
    }
}

impl fmt::Debug for DdsParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DdsParameter")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

/// Wakes the thread that waits for a future.
struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

/// Runs `future` on this thread to its end.
fn run<F: Future>(future: F) -> F::Output {
    let waker = Waker::from(Arc::new(Unpark(thread::current())));
    let mut context = Context::from_waker(&waker);
    let mut future = pin!(future);
    loop {
        match future.as_mut().poll(&mut context) {
            Poll::Ready(output) => return output,
            Poll::Pending => thread::park(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_future_that_waits_for_another_thread_is_run_to_its_end() {
        let (sender, receiver) = std::sync::mpsc::channel::<Waker>();
        let mut polls = 0;
        let other = thread::spawn(move || {
            for waker in receiver {
                waker.wake();
            }
        });
        let future = std::future::poll_fn(move |context| {
            polls += 1;
            if polls == 5 {
                return Poll::Ready(polls);
            }
            let _ = sender.send(context.waker().clone());
            Poll::Pending
        });
        assert_eq!(run(future), 5);
        other.join().unwrap();
    }
}
