//! The SUMO of a run: over TraCI, or in this process where the feature `libsumo` allows for it.

#[cfg(not(feature = "libsumo"))]
pub use super::traci_link::TraciLink as Link;
#[cfg(feature = "libsumo")]
pub use either::Link;

use super::traci_link::TraciLink;
use crate::traci::Client;

impl Link {
    /// A SUMO that is connected over TraCI; `shared` if other clients may be at it.
    pub fn traci(client: Client, shared: bool) -> Self {
        let link = TraciLink::new(client, shared);
        #[cfg(feature = "libsumo")]
        let link = Self::from(link);
        link
    }
}

/// One of the two, chosen when the run begins.
#[cfg(feature = "libsumo")]
mod either {
    use super::super::error::CosimError;
    use super::super::events::Events;
    use super::super::libsumo_link::{self, LibsumoLink};
    use super::super::question::{NoAnswer, Object, Question};
    use super::super::sumo::{Joined, Sumo, Tell};
    use super::super::traci_link::{self, TraciLink};
    use crate::traci::Ticket;
    use std::time::Duration;

    /// A SUMO over TraCI, or in this process.
    pub enum Link {
        /// Over TraCI.
        Traci(Box<TraciLink>),
        /// In this process.
        Libsumo(LibsumoLink),
    }

    /// Questions to one of them; both to a link are of the same kind.
    pub enum Asked<Q> {
        /// Over TraCI.
        Traci(traci_link::Asked<Q>),
        /// In this process.
        Libsumo(libsumo_link::Asked<Q>),
    }

    impl From<TraciLink> for Link {
        fn from(link: TraciLink) -> Self {
            Self::Traci(Box::new(link))
        }
    }

    impl From<LibsumoLink> for Link {
        fn from(link: LibsumoLink) -> Self {
            Self::Libsumo(link)
        }
    }

    impl<Q> Default for Asked<Q> {
        fn default() -> Self {
            Self::Traci(Default::default())
        }
    }

    impl<Q> Asked<Q> {
        /// As questions over TraCI; memory of the other kind has none.
        fn traci(self) -> traci_link::Asked<Q> {
            if let Self::Traci(asked) = self { asked } else { Default::default() }
        }

        /// As questions in this process; memory of the other kind has none.
        fn libsumo(self) -> libsumo_link::Asked<Q> {
            if let Self::Libsumo(asked) = self { asked } else { Default::default() }
        }
    }

    /// The same call of whichever it is.
    macro_rules! either {
        ($link:ident, $of:ident => $call:expr) => {
            match $link {
                Link::Traci($of) => $call,
                Link::Libsumo($of) => $call,
            }
        };
    }

    impl Sumo for Link {
        /// A ticket of TraCI; in this process a step has been made.
        type Step = Option<Ticket>;
        type Asked<Q: Question> = Asked<Q>;

        async fn join(&mut self) -> Result<Joined, CosimError> {
            either!(self, link => link.join().await)
        }

        async fn end_s(&mut self) -> Result<f64, CosimError> {
            either!(self, link => link.end_s().await)
        }

        async fn option(&mut self, name: &str) -> Result<Option<String>, CosimError> {
            either!(self, link => link.option(name).await)
        }

        fn tell(&mut self, vehicle: &Object, what: Tell) -> Result<(), CosimError> {
            either!(self, link => link.tell(vehicle, what))
        }

        fn watch<Q: Question>(&mut self, vehicle: &Object, question: &Q) -> Result<(), CosimError> {
            either!(self, link => link.watch(vehicle, question))
        }

        fn unwatch(&mut self, vehicle: &Object) -> Result<(), CosimError> {
            either!(self, link => link.unwatch(vehicle))
        }

        async fn hand_over(&mut self) -> Result<(), CosimError> {
            either!(self, link => link.hand_over().await)
        }

        async fn step(&mut self) -> Result<Option<Ticket>, CosimError> {
            match self {
                Self::Traci(link) => link.step().await.map(Some),
                Self::Libsumo(link) => link.step().await.map(|()| None),
            }
        }

        async fn events(&mut self, step: Option<Ticket>, events: &mut Events) -> Result<(), CosimError> {
            match (self, step) {
                (Self::Traci(link), Some(ticket)) => link.events(ticket, events).await,
                (Self::Traci(_), None) => unreachable!("a step over TraCI has a ticket"),
                (Self::Libsumo(link), _) => link.events((), events).await,
            }
        }

        fn ask_in<'o, Q: Question>(
            &mut self,
            room: Asked<Q>,
            questions: impl Iterator<Item = (&'o Object, Q)>,
        ) -> Result<Asked<Q>, CosimError> {
            match self {
                Self::Traci(link) => link.ask_in(room.traci(), questions).map(Asked::Traci),
                Self::Libsumo(link) => link.ask_in(room.libsumo(), questions).map(Asked::Libsumo),
            }
        }

        async fn answers<Q: Question>(
            &mut self,
            asked: Asked<Q>,
            each: impl for<'a> FnMut(Q, Result<Q::Answer<'a>, NoAnswer>),
        ) -> Result<Asked<Q>, CosimError> {
            match self {
                Self::Traci(link) => link.answers(asked.traci(), each).await.map(Asked::Traci),
                Self::Libsumo(link) => link.answers(asked.libsumo(), each).await.map(Asked::Libsumo),
            }
        }

        async fn leave(&mut self) -> Result<(), CosimError> {
            either!(self, link => link.leave().await)
        }

        async fn close(self) -> Result<(), CosimError> {
            either!(self, link => link.close().await)
        }

        fn waited(&self) -> Duration {
            either!(self, link => link.waited())
        }
    }
}
