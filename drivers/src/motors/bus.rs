//! Instructions and answers on a port.

use std::{
    io,
    marker::PhantomData,
    time::{Duration, Instant},
};

use super::{
    error::Lost,
    port::Port,
    protocol::{Answer, EVERYBODY, Found, Instruction, Protocol},
};

/// How long an answer may take beside the bytes' own time, before anything moves.
const FIRST_PATIENCE: Duration = Duration::from_millis(100);
/// The most that it is then: an adapter hands over what it got after 16 ms at the latest, as
/// its maker has set it.
const PATIENCE: Duration = Duration::from_millis(20);
/// The least that it is once one knows how long they do take.
const LEAST_PATIENCE: Duration = Duration::from_millis(4);

/// A bus of motors that speak `P`.
pub struct Bus<P> {
    port: Port,
    packet: Vec<u8>,
    parameters: Vec<u8>,
    input: Vec<u8>,
    damaged: u32,
    patience: Duration,
    /// When the last instruction was sent, and the longest time from there to an answer.
    sent: Instant,
    slowest: Duration,
    protocol: PhantomData<P>,
}

impl<P: Protocol> Bus<P> {
    /// A bus on `port`.
    pub fn new(port: Port) -> Bus<P> {
        Bus {
            port,
            packet: Vec::with_capacity(512),
            parameters: Vec::with_capacity(512),
            input: Vec::with_capacity(1024),
            damaged: 0,
            patience: FIRST_PATIENCE,
            sent: Instant::now(),
            slowest: Duration::ZERO,
            protocol: PhantomData,
        }
    }

    /// How many answers had a wrong checksum since the start.
    pub fn damaged(&self) -> u32 {
        self.damaged
    }

    /// Waits from here on no longer for an answer than by what those so far took: one that is
    /// lost costs little then.
    pub fn settle(&mut self) {
        self.patience = (2 * self.slowest).clamp(LEAST_PATIENCE, PATIENCE);
    }

    /// Whether motor `id` is there; what it says of itself.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn ping(&mut self, id: u8) -> Result<Box<Answer>, Lost> {
        self.send(id, Instruction::Ping, |_| ())?;
        // What it says beside that it is there differs between makers.
        self.answer_of(id, None, self.deadline(P::FRAME + 3))
    }

    /// The `length` registers of motor `id` from `address` on.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn read(&mut self, id: u8, address: u16, length: usize) -> Result<Box<Answer>, Lost> {
        self.send(id, Instruction::Read, |parameters| {
            P::write_number(parameters, address);
            P::write_number(parameters, length as u16);
        })?;
        let deadline = self.deadline(P::FRAME + length);
        self.answer_of(id, Some(length), deadline)
    }

    /// Gives motor `id` the registers `data` from `address` on.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn write(&mut self, id: u8, address: u16, data: &[u8]) -> Result<Box<Answer>, Lost> {
        self.send(id, Instruction::Write, |parameters| {
            P::write_number(parameters, address);
            parameters.extend(data);
        })?;
        let deadline = self.deadline(P::FRAME);
        self.answer_of(id, Some(0), deadline)
    }

    /// Gives each motor the `N` registers from `address` on that stand beside its id.
    ///
    /// # Errors
    ///
    /// The port is gone; the motors do not answer to this.
    pub fn sync_write<const N: usize>(
        &mut self,
        address: u16,
        registers: impl Iterator<Item = (u8, [u8; N])>,
    ) -> Result<(), Lost> {
        self.send(EVERYBODY, Instruction::SyncWrite, |parameters| {
            P::write_number(parameters, address);
            P::write_number(parameters, N as u16);
            for (id, registers) in registers {
                parameters.push(id);
                parameters.extend(registers);
            }
        })
    }

    /// Asks all `ids` for their `length` registers from `address` on; `each` gets what they
    /// answer, in that order, with the place in it.
    ///
    /// # Errors
    ///
    /// The first that is missing; those after it are not waited for.
    pub fn sync_read(
        &mut self,
        ids: &[u8],
        address: u16,
        length: usize,
        mut each: impl FnMut(usize, &Answer),
    ) -> Result<(), (usize, Lost)> {
        self.ask_all(Instruction::SyncRead, ids, address, length)
            .map_err(|lost| (0, lost))?;
        let deadline = self.deadline(ids.len() * (P::FRAME + length));
        for (place, &id) in ids.iter().enumerate() {
            let answer = self
                .answer_of(id, Some(length), deadline)
                .map_err(|lost| (place, lost))?;
            each(place, &answer);
        }
        Ok(())
    }

    /// Asks all `ids` for registers and gives the one answer of all.
    ///
    /// # Errors
    ///
    /// No answer.
    pub fn fast_sync_read(
        &mut self,
        ids: &[u8],
        address: u16,
        length: usize,
        answer: usize,
    ) -> Result<Box<Answer>, Lost> {
        self.ask_all(Instruction::FastSyncRead, ids, address, length)?;
        let deadline = self.deadline(P::FRAME + answer);
        self.answer_of(EVERYBODY, Some(answer), deadline)
    }

    fn ask_all(
        &mut self,
        instruction: Instruction,
        ids: &[u8],
        address: u16,
        length: usize,
    ) -> Result<(), Lost> {
        self.send(EVERYBODY, instruction, |parameters| {
            P::write_number(parameters, address);
            P::write_number(parameters, length as u16);
            parameters.extend(ids);
        })
    }

    fn send(
        &mut self,
        id: u8,
        instruction: Instruction,
        parameters: impl FnOnce(&mut Vec<u8>),
    ) -> Result<(), Lost> {
        self.parameters.clear();
        parameters(&mut self.parameters);
        P::write(&mut self.packet, id, instruction, &self.parameters);
        self.input.clear();
        self.sent = Instant::now();
        self.port.send(&self.packet).map_err(Lost::Port)
    }

    fn deadline(&self, bytes: usize) -> Instant {
        Instant::now() + self.port.time_of(self.packet.len() + bytes) + self.patience
    }

    /// The answer of motor `id`; one of another motor is none.
    fn answer_of(
        &mut self,
        id: u8,
        length: Option<usize>,
        deadline: Instant,
    ) -> Result<Box<Answer>, Lost> {
        let answer = self.answer(deadline)?;
        let fits = length.is_none_or(|length| {
            answer.data().len() == length || P::refusal(answer.error).is_some()
        });
        match answer.id == id && fits {
            true => Ok(answer),
            false => Err(Lost::Foreign),
        }
    }

    fn answer(&mut self, deadline: Instant) -> Result<Box<Answer>, Lost> {
        loop {
            match P::find(&self.input) {
                Found::Answer(answer, length) => {
                    self.input.drain(..length);
                    self.slowest = self.slowest.max(self.sent.elapsed());
                    return Ok(answer);
                }
                Found::Damaged(length) => {
                    self.input.drain(..length);
                    self.damaged = self.damaged.saturating_add(1);
                    return Err(Lost::Damaged);
                }
                Found::Garbage(length) => {
                    self.input.drain(..length);
                }
                Found::Nothing => {
                    let mut bytes = [0; 512];
                    match self.port.receive(&mut bytes, deadline) {
                        Ok(0) => return Err(Lost::Silent),
                        Ok(count) => self.input.extend(&bytes[..count]),
                        Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                        Err(error) => return Err(Lost::Port(error)),
                    }
                }
            }
        }
    }
}
