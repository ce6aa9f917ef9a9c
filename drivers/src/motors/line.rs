//! The motors of an arm's section on their bus: registers by the motor's place in the section.

use super::{
    bus::Bus,
    error::{Lost, MotorError},
    family::Missed,
    port::Port,
    protocol::{Answer, Protocol},
    section::Section,
};

/// How often a motor is asked for one thing.
const ATTEMPTS: usize = 3;

/// The motors of a section.
pub struct Line<P> {
    /// The bus that they are on.
    pub bus: Bus<P>,
    /// What the arm's file says of them.
    pub section: Section,
    /// Their numbers on the bus.
    pub ids: Vec<u8>,
}

impl<P: Protocol> Line<P> {
    /// Opens the port of `section`.
    ///
    /// # Errors
    ///
    /// It is not to be had.
    pub fn open(section: &Section) -> Result<Line<P>, MotorError> {
        Ok(Line {
            bus: Bus::new(Port::open(&section.port, section.baud)?),
            section: section.clone(),
            ids: section.motor.iter().map(|motor| motor.id).collect(),
        })
    }

    /// Has all motors say that they are there; gives what they say.
    ///
    /// # Errors
    ///
    /// Who is missing.
    pub fn call(&mut self) -> Result<Vec<Box<Answer>>, MotorError> {
        let (mut found, mut missing) = (Vec::new(), Vec::new());
        for place in 0..self.ids.len() {
            let id = self.ids[place];
            match self.tried(|bus| bus.ping(id)) {
                Ok(answer) => found.push(answer),
                Err(Lost::Port(source)) => return Err(self.lost(place, Lost::Port(source))),
                Err(_) => missing.push(place),
            }
        }
        match missing.first() {
            None => Ok(found),
            Some(_) if found.is_empty() => Err(MotorError::NoMotors {
                port: self.section.port.clone(),
                baud: self.section.baud,
                ids: format!("{:?}", self.ids),
            }),
            Some(place) => Err(MotorError::Missing(self.section.name(*place))),
        }
    }

    /// The `N` registers of a motor from `address` on.
    ///
    /// # Errors
    ///
    /// It does not give them.
    pub fn get<const N: usize>(
        &mut self,
        place: usize,
        address: u16,
    ) -> Result<[u8; N], MotorError> {
        let id = self.ids[place];
        let answer = self.tried(|bus| bus.read(id, address, N));
        let answer = self.accepted(place, address, answer)?;
        match answer.data().first_chunk() {
            Some(registers) => Ok(*registers),
            None => Err(self.lost(place, Lost::Foreign)),
        }
    }

    /// Gives a motor the registers `data` from `address` on.
    ///
    /// # Errors
    ///
    /// It does not take them.
    pub fn set(&mut self, place: usize, address: u16, data: &[u8]) -> Result<(), MotorError> {
        let id = self.ids[place];
        let answer = self.tried(|bus| bus.write(id, address, data));
        self.accepted(place, address, answer).map(drop)
    }

    /// Gives all motors the same registers, one after the other, and hears of each that it took
    /// them.
    ///
    /// # Errors
    ///
    /// The first that does not.
    pub fn set_surely(&mut self, address: u16, data: &[u8]) -> Result<(), Missed> {
        for place in 0..self.ids.len() {
            let id = self.ids[place];
            let answer = self.tried(|bus| bus.write(id, address, data));
            let answer = answer.map_err(|lost| Missed::Motor(place, lost))?;
            self.accepted(place, address, Ok(answer))?;
        }
        Ok(())
    }

    /// Whether all drives are on, as register `address` says.
    ///
    /// # Errors
    ///
    /// One that is off, by itself or as it was without power; one that does not say.
    pub fn are_on(&mut self, address: u16) -> Result<(), Missed> {
        let mut off = None;
        self.get_all(address, |place, _, &[on]| {
            if on == 0 {
                off = off.or(Some(place));
            }
        })?;
        match off {
            None => Ok(()),
            Some(place) => {
                let what = "off by itself (was its power interrupted?)".to_owned();
                Err(self.hardware(place, what).into())
            }
        }
    }

    /// Gives all motors the same registers; nothing answers to this.
    ///
    /// # Errors
    ///
    /// The port is gone.
    pub fn set_all<const N: usize>(&mut self, address: u16, data: [u8; N]) -> Result<(), Missed> {
        self.set_each(address, |_| data)
    }

    /// Gives each motor the registers of its place.
    ///
    /// # Errors
    ///
    /// The port is gone.
    pub fn set_each<const N: usize>(
        &mut self,
        address: u16,
        data: impl Fn(usize) -> [u8; N],
    ) -> Result<(), Missed> {
        let ids = self.ids.iter().enumerate();
        let all = ids.map(|(place, id)| (*id, data(place)));
        let told = self.bus.sync_write(address, all);
        told.map_err(|lost| Missed::Motor(0, lost))
    }

    /// The `N` registers of all motors; `each` gets them with the motor's place and error.
    ///
    /// # Errors
    ///
    /// The first that is missing.
    pub fn get_all<const N: usize>(
        &mut self,
        address: u16,
        mut each: impl FnMut(usize, u8, &[u8; N]),
    ) -> Result<(), Missed> {
        let take = |place: usize, answer: &Answer| {
            if let Some(data) = answer.data().first_chunk() {
                each(place, answer.error, data);
            }
        };
        let read = self.bus.sync_read(&self.ids, address, N, take);
        read.map_err(|(place, lost)| Missed::Motor(place, lost))
    }

    /// The places of those that do not answer.
    pub fn silent(&mut self) -> Vec<usize> {
        let mut is_silent = |id: u8| matches!(self.bus.ping(id), Err(Lost::Silent));
        let ids = self.ids.iter().enumerate();
        let silent = ids.filter(|(_, id)| is_silent(**id));
        silent.map(|(place, _)| place).collect()
    }

    /// Does it again where an answer got lost: one alone means nothing.
    fn tried(
        &mut self,
        mut exchange: impl FnMut(&mut Bus<P>) -> Result<Box<Answer>, Lost>,
    ) -> Result<Box<Answer>, Lost> {
        for _ in 1..ATTEMPTS {
            match exchange(&mut self.bus) {
                Err(Lost::Silent | Lost::Damaged | Lost::Foreign) => {}
                done => return done,
            }
        }
        exchange(&mut self.bus)
    }

    fn accepted(
        &self,
        place: usize,
        address: u16,
        answer: Result<Box<Answer>, Lost>,
    ) -> Result<Box<Answer>, MotorError> {
        let answer = answer.map_err(|lost| self.lost(place, lost))?;
        match P::refusal(answer.error) {
            None => Ok(answer),
            Some(reason) => Err(MotorError::Refused {
                motor: self.section.name(place),
                address,
                reason,
            }),
        }
    }

    /// What a motor that is lost is told as, before it has begun.
    pub fn lost(&self, place: usize, lost: Lost) -> MotorError {
        match lost {
            Lost::Port(source) => MotorError::Gone {
                port: self.section.port.clone(),
                source,
            },
            Lost::Silent => MotorError::Missing(self.section.name(place)),
            Lost::Damaged | Lost::Foreign => {
                self.setting(place, "its answers are damaged; check the cable".to_owned())
            }
        }
    }

    /// The same of a cycle.
    pub fn missed(&self, missed: Missed) -> MotorError {
        match missed {
            Missed::Error(error) => error,
            Missed::Motor(place, lost) => self.lost(place, lost),
        }
    }

    /// Something about a motor that has to be set otherwise.
    pub fn setting(&self, place: usize, message: String) -> MotorError {
        self.section.setting(place, message)
    }

    /// A motor says that something is wrong with it.
    pub fn hardware(&self, place: usize, what: String) -> MotorError {
        MotorError::Hardware {
            motor: self.section.name(place),
            what,
        }
    }

    /// It is another motor than the file says.
    pub fn other_model(&self, place: usize, found: String) -> MotorError {
        MotorError::Model {
            motor: self.section.name(place),
            found,
            wanted: self.section.motor[place].model.clone(),
        }
    }
}
