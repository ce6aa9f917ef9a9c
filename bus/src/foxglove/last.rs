//! The last message of every state topic, for those who subscribe later.

use std::{
    collections::HashMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
};

use foxglove::{
    ChannelId, Context, RawChannel,
    websocket::{ChannelView, Client, ServerListener},
};

/// Hands the last message of a channel to a client that subscribes.
pub(super) struct LastMessages {
    // Weak: the context's server holds this.
    context: Weak<Context>,
    bytes: Mutex<HashMap<ChannelId, Vec<u8>>>,
}

impl LastMessages {
    pub(super) fn new(context: &Arc<Context>) -> LastMessages {
        LastMessages {
            context: Arc::downgrade(context),
            bytes: Mutex::default(),
        }
    }

    /// A poisoned lock says that another thread panicked; whole messages are kept only.
    fn lock(&self) -> MutexGuard<'_, HashMap<ChannelId, Vec<u8>>> {
        self.bytes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends `bytes` and keeps them. One lock for both, so that a client that
    /// subscribes meanwhile gets the newest last.
    pub(super) fn send(&self, channel: &RawChannel, bytes: &[u8], send: impl FnOnce(&RawChannel)) {
        let mut last = self.lock();
        let kept = last.entry(channel.id()).or_default();
        kept.clear();
        kept.extend_from_slice(bytes);
        send(channel);
    }
}

impl ServerListener for LastMessages {
    fn on_subscribe(&self, client: Client, view: ChannelView) {
        let last = self.lock();
        let context = self.context.upgrade();
        let channel = context.and_then(|context| context.get_channel_by_topic(view.topic()));
        if let (Some(bytes), Some(channel)) = (last.get(&view.id()), channel) {
            channel.log_to_sink(bytes, client.sink_id());
        }
    }
}
