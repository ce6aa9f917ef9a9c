//! What stands in shared memory for one message.

use std::fmt;

use ferntast_msgs::Message;
use iceoryx2::prelude::ZeroCopySend;

/// A message with what the reader needs to know about it.
#[derive(Clone, Copy)]
#[repr(C)]
pub(super) struct Payload<M: Message> {
    /// When it was published \[ns since 1970\].
    pub(super) published: i64,
    /// How many this publisher sent before: gaps are what a full queue dropped.
    pub(super) number: u64,
    /// The sample.
    pub(super) message: M,
}

// SAFETY: `Message` promises a `repr(C)` type without pointers for which
// every bit pattern is a value; two integers beside it change nothing of that.
// The type's name is the sample's, so that two programs that mean different
// samples by one topic do not meet; iceoryx2 compares size and alignment too.
unsafe impl<M: Message> ZeroCopySend for Payload<M> {
    unsafe fn type_name() -> &'static str {
        std::any::type_name::<M>()
    }
}

impl<M: Message> fmt::Debug for Payload<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message.fmt(f)
    }
}
