//! The exchange with a running SUMO: messages out, answers in.
//!
//! SUMO answers each message as a whole and goes on to the next one that lies in its socket. [`Client::exchange`] sends
//! one message and waits for its answer. [`Client::send`] does not wait: it returns a [`Ticket`], and [`Client::receive`]
//! takes the ticket and returns exactly the answer to that message. So several messages can be under way, and SUMO works
//! on the next one while the answer to the last one is used.

use std::collections::VecDeque;
use std::fmt;
use std::io::{Error as IoError, ErrorKind};
use std::ops::Range;
use std::sync::{Arc, Weak};
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::tcp::ReadHalf;
use tokio::net::{TcpStream, ToSocketAddrs};
use tokio::time::{Instant, sleep, timeout};

use super::batch::{Batch, Expected};
use super::error::Error;
use super::reply::{Index, Reply};
use super::subscription::Variables;
use super::typed::{Domain, FromValue, Shape, Var};
use super::version::SumoVersion;
use super::wire::{DecodeError, frame_length};

/// The buffer for replies begins at this size [bytes] and grows as needed; a wrong length cannot make it grow ahead of
/// the bytes that really come.
const INBOX_BYTES: usize = 1 << 16;
/// Pause between attempts to connect while SUMO is starting.
const RETRY: Duration = Duration::from_millis(5);

/// The right to the answer to one message. A ticket that is dropped gives the answer up: it is thrown away when it comes.
#[must_use = "the answer is thrown away with its ticket"]
#[derive(Debug)]
pub struct Ticket(Arc<()>);

/// A message whose answer has not been handed out yet.
#[derive(Debug)]
struct Pending {
    /// Dead once the ticket has been dropped.
    ticket: Weak<()>,
    /// Number of its commands.
    commands: usize,
    state: Answer,
}

/// How far the answer to a message has come.
#[derive(Debug)]
enum Answer {
    /// SUMO has not sent it, or it has not been read.
    UnderWay,
    /// It lies in the inbox, because the answer to a later message was wanted first.
    Kept(Range<usize>),
    /// Handed out or given up.
    Done,
}

/// A connection to SUMO. Every call ends within the client's timeout; after an error that is not a refusal the
/// connection is finished.
#[derive(Debug)]
pub struct Client {
    stream: TcpStream,
    outbox: Vec<u8>,
    inbox: Vec<u8>,
    /// Number of bytes at the beginning of the inbox that have been divided into answers.
    divided: usize,
    /// Where the answer that was handed out last lies in the inbox.
    current: Range<usize>,
    /// The messages from the first one that is not done, in the order of sending, and the commands of all of them.
    pending: VecDeque<Pending>,
    /// Marks of tickets that nobody knows any more, to be used again.
    spare: Vec<Arc<()>>,
    commands: VecDeque<Expected>,
    index: Index,
    single: Batch,
    version: SumoVersion,
    timeout: Duration,
    waited: Duration,
    finished: bool,
}

impl Client {
    /// Connects to a SUMO that runs or is about to: tries until `limit` has passed, which must cover the loading of the
    /// network. Connected is not ready; the answer to the first request is, so that is awaited too. `limit` is also the
    /// timeout of later calls until [`Client::set_timeout`] changes it.
    ///
    /// # Errors
    /// [`Error::Connect`] if nobody listens, [`Error::Disconnected`] if SUMO ends while loading, [`Error::TooOld`],
    /// [`Error::Timeout`].
    pub async fn connect(address: impl ToSocketAddrs + fmt::Display, limit: Duration) -> Result<Self, Error> {
        Self::join(address, limit, limit).await
    }

    /// Like [`Client::connect`], but only as long as `reach` for somebody to listen at all: to a SUMO that should run.
    ///
    /// # Errors
    /// As [`Client::connect`].
    pub async fn join(
        address: impl ToSocketAddrs + fmt::Display,
        reach: Duration,
        limit: Duration,
    ) -> Result<Self, Error> {
        let begun = Instant::now();
        loop {
            match timeout(reach, TcpStream::connect(&address)).await {
                Ok(Ok(stream)) => return Self::greet(stream, begun + limit, limit).await,
                Ok(Err(_)) if begun.elapsed() < reach => sleep(RETRY).await,
                Ok(Err(source)) => return Err(Error::Connect { address: address.to_string(), source }),
                Err(_) => return Err(Error::Timeout { after: limit }),
            }
        }
    }

    /// Takes over a fresh connection and waits until SUMO is ready.
    async fn greet(stream: TcpStream, deadline: Instant, limit: Duration) -> Result<Self, Error> {
        stream.set_nodelay(true).map_err(Error::Disconnected)?;
        let mut client = Self {
            stream,
            outbox: Vec::new(),
            inbox: Vec::with_capacity(INBOX_BYTES),
            divided: 0,
            current: 0..0,
            pending: VecDeque::new(),
            spare: Vec::new(),
            commands: VecDeque::new(),
            index: Index::default(),
            single: Batch::new(),
            version: SumoVersion::parse(0, ""),
            timeout: deadline.saturating_duration_since(Instant::now()).max(RETRY),
            waited: Duration::ZERO,
            finished: false,
        };
        let mut batch = Batch::new();
        batch.version()?;
        let reply = client.exchange(&batch).await?;
        let (api, text) = reply.version()?.ok_or(DecodeError { offset: 4, what: "no version" })?;
        client.version = SumoVersion::parse(api, text);
        client.timeout = limit;
        tracing::debug!(version = %client.version, api, "connected to SUMO");
        if client.version.number < SumoVersion::MINIMUM {
            return Err(Error::TooOld { found: client.version });
        }
        Ok(client)
    }

    /// The version of the SUMO at the other end.
    #[must_use]
    pub fn version(&self) -> &SumoVersion {
        &self.version
    }

    /// Sets the time any later call may take.
    pub fn set_timeout(&mut self, limit: Duration) {
        self.timeout = limit;
    }

    /// Time spent so far from the first byte of a message to the last byte of its answer: SUMO's work and the socket's.
    #[must_use]
    pub fn waited(&self) -> Duration {
        self.waited
    }

    /// Sends a batch and waits for the reply. Nothing is allocated for it once the buffers have grown. Commands that SUMO
    /// declines are data in the reply, not an error.
    ///
    /// # Errors
    /// [`Error::Empty`], [`Error::Timeout`], [`Error::Disconnected`], [`Error::Decode`]; the last three, and dropping
    /// the future midway, finish the connection.
    pub async fn exchange(&mut self, batch: &Batch) -> Result<Reply<'_>, Error> {
        let ticket = self.send(batch).await?;
        self.receive(ticket).await
    }

    /// Sends a batch and does not wait for the reply. SUMO works on a batch after the ones before it, so gets behind a
    /// step see the state after it.
    ///
    /// # Errors
    /// As [`Client::exchange`].
    pub async fn send(&mut self, batch: &Batch) -> Result<Ticket, Error> {
        let ticket = self.queue(batch)?;
        self.flush().await?;
        Ok(ticket)
    }

    /// Puts a batch behind those that wait to be sent. The next call that sends or receives sends them all with one
    /// write.
    ///
    /// # Errors
    /// [`Error::Empty`], [`Error::Finished`].
    pub fn queue(&mut self, batch: &Batch) -> Result<Ticket, Error> {
        let ticket = Ticket(self.spare.pop().unwrap_or_default());
        self.put(batch, Arc::downgrade(&ticket.0))?;
        Ok(ticket)
    }

    /// The same where nobody will ask for the answer.
    ///
    /// # Errors
    /// As [`Client::queue`].
    pub fn queue_unheard(&mut self, batch: &Batch) -> Result<(), Error> {
        self.put(batch, Weak::new())
    }

    fn put(&mut self, batch: &Batch, ticket: Weak<()>) -> Result<(), Error> {
        if self.finished {
            return Err(Error::Finished);
        }
        if batch.is_empty() {
            return Err(Error::Empty);
        }
        self.outbox.extend_from_slice(batch.bytes());
        self.commands.extend(batch.expected());
        self.pending.push_back(Pending { ticket, commands: batch.len(), state: Answer::UnderWay });
        Ok(())
    }

    /// Sends the batches that wait in the queue.
    ///
    /// # Errors
    /// As [`Client::exchange`].
    pub async fn flush(&mut self) -> Result<(), Error> {
        if self.finished {
            return Err(Error::Finished);
        }
        if self.outbox.is_empty() {
            return Ok(());
        }
        // Until everything has gone well: half a message must not be followed by another.
        self.finished = true;
        let begun = Instant::now();
        let (rx, mut tx) = self.stream.split();
        let write = async { tx.write_all(&self.outbox).await.map_err(Error::Disconnected) };
        // SUMO does not read on while nobody takes its answers.
        let written = async {
            tokio::select! {
                biased;
                written = write => written,
                error = listen(rx, &mut self.inbox) => Err(error),
            }
        };
        timeout(self.timeout, written).await.map_err(|_| Error::Timeout { after: self.timeout })??;
        self.outbox.clear();
        self.waited += begun.elapsed();
        self.finished = false;
        Ok(())
    }

    /// The answer to the message of the ticket. Answers to earlier messages that come first are kept for their tickets.
    ///
    /// # Errors
    /// As [`Client::exchange`]; [`Error::Empty`] for a ticket of another client.
    pub async fn receive(&mut self, ticket: Ticket) -> Result<Reply<'_>, Error> {
        self.flush().await?;
        let of_ticket = |pending: &Pending| pending.ticket.as_ptr() == Arc::as_ptr(&ticket.0);
        let place = self.pending.iter().position(of_ticket).ok_or(Error::Empty)?;
        // A half-read answer must never be taken for the answer to the next message.
        self.finished = true;
        let first = self.pending.iter().take(place).map(|pending| pending.commands).sum::<usize>();
        let commands = first..first + self.pending[place].commands;
        self.current = self.read_to(place).await?;
        self.index.fill(&self.inbox[self.current.clone()], self.commands.range(commands).copied())?;
        while let Some(Pending { commands, state: Answer::Done, .. }) = self.pending.front() {
            self.commands.drain(..commands);
            self.pending.pop_front();
        }
        if Arc::weak_count(&ticket.0) == 0 {
            self.spare.push(ticket.0);
        }
        self.finished = false;
        Ok(self.index.reply(&self.inbox[self.current.clone()]))
    }

    /// Reads answers up to that of the message at `place`, and marks it as done.
    async fn read_to(&mut self, place: usize) -> Result<Range<usize>, Error> {
        let is_kept = |pending: &Pending| matches!(pending.state, Answer::Kept(_));
        if self.divided == self.inbox.len() && !self.pending.iter().any(is_kept) {
            self.inbox.clear();
            self.divided = 0;
        }
        let begun = Instant::now();
        for at in 0..=place {
            if !matches!(self.pending[at].state, Answer::UnderWay) {
                continue;
            }
            let read = read_frame(&mut self.stream, &mut self.inbox, self.divided);
            let length = timeout(self.timeout, read).await.map_err(|_| Error::Timeout { after: self.timeout })??;
            let frame = self.divided..self.divided + length;
            self.divided = frame.end;
            let pending = &mut self.pending[at];
            pending.state = if pending.ticket.strong_count() > 0 { Answer::Kept(frame) } else { Answer::Done };
        }
        self.waited += begun.elapsed();
        let last_is_read = self.pending.back().is_some_and(|last| !matches!(last.state, Answer::UnderWay));
        if last_is_read && self.inbox.len() > self.divided {
            // SUMO speaks only when asked.
            return Err(DecodeError { offset: self.divided, what: "bytes behind the answer" }.into());
        }
        match std::mem::replace(&mut self.pending[place].state, Answer::Done) {
            Answer::Kept(frame) => Ok(frame),
            Answer::UnderWay | Answer::Done => Err(Error::Empty),
        }
    }

    /// Sends a batch with one command built by `build`, and fails if SUMO declines it.
    async fn single<R>(&mut self, build: impl FnOnce(&mut Batch) -> Result<R, Error>) -> Result<(R, Reply<'_>), Error> {
        let mut batch = std::mem::take(&mut self.single);
        batch.clear();
        let built = build(&mut batch);
        let sent = match &built {
            Ok(_) => self.exchange(&batch).await.map(drop),
            Err(_) => Ok(()),
        };
        self.single = batch;
        let built = built?;
        sent?;
        let reply = self.index.reply(&self.inbox[self.current.clone()]);
        match reply.refusals().next() {
            Some((_, refusal)) => Err(refusal.into()),
            None => Ok((built, reply)),
        }
    }

    /// Reads one variable of the object `id`.
    ///
    /// # Errors
    /// As [`Client::exchange`] and [`Reply::get`].
    pub async fn get<T: FromValue, S>(&mut self, variable: Var<T, S>, id: &str) -> Result<T, Error> {
        self.get_with(variable, id, ()).await
    }

    /// Reads one variable that takes a parameter.
    ///
    /// # Errors
    /// As [`Client::get`].
    pub async fn get_with<T: FromValue, S, P: Shape>(
        &mut self,
        variable: Var<T, S, P>,
        id: &str,
        parameter: P::Arg<'_>,
    ) -> Result<T, Error> {
        let (handle, reply) = self.single(|batch| Ok(batch.get_with(variable, id, parameter)?)).await?;
        reply.get(handle)
    }

    /// Sets one variable of the object `id`.
    ///
    /// # Errors
    /// As [`Client::exchange`], and [`Error::Refused`].
    pub async fn set<T, S: Shape, P>(
        &mut self,
        variable: Var<T, S, P>,
        id: &str,
        value: S::Arg<'_>,
    ) -> Result<(), Error> {
        self.single(|batch| Ok(batch.set(variable, id, value)?)).await.map(|_| ())
    }

    /// Subscribes to variables of an object from `begin_s` = the present simulation time \[s\] on; see
    /// [`Batch::subscribe`]. The reply holds the present values.
    ///
    /// # Errors
    /// As [`Client::set`].
    pub async fn subscribe<V: Variables>(
        &mut self,
        variables: V,
        id: &str,
        begin_s: f64,
    ) -> Result<(Range<usize>, Reply<'_>), Error> {
        self.single(|batch| Ok(batch.subscribe(variables, id, begin_s)?)).await
    }

    /// Ends all subscriptions of an object.
    ///
    /// # Errors
    /// As [`Client::set`].
    pub async fn unsubscribe(&mut self, domain: Domain, id: &str) -> Result<(), Error> {
        self.single(|batch| Ok(batch.unsubscribe(domain, id)?)).await.map(|_| ())
    }

    /// Makes one simulation step; the reply holds the subscribed values.
    ///
    /// # Errors
    /// As [`Client::set`].
    pub async fn step(&mut self) -> Result<Reply<'_>, Error> {
        self.single(|batch| Ok(batch.step()?)).await.map(|(_, reply)| reply)
    }

    /// Steps until the simulation time is at least `time_s` \[s\].
    ///
    /// # Errors
    /// As [`Client::set`].
    pub async fn step_until(&mut self, time_s: f64) -> Result<Reply<'_>, Error> {
        self.single(|batch| Ok(batch.step_until(time_s)?)).await.map(|(_, reply)| reply)
    }

    /// Tells SUMO this client's place among several. With `--num-clients` above 1 it must come before everything else.
    /// SUMO serves nobody until all clients are connected, and answers a client's first request only when those before
    /// it have told their place: connect and set the order in one go, concurrently with the other clients.
    ///
    /// # Errors
    /// As [`Client::set`].
    pub async fn set_order(&mut self, order: i32) -> Result<(), Error> {
        self.single(|batch| Ok(batch.order(order)?)).await.map(|_| ())
    }

    /// Ends the session; SUMO completes its outputs and ends with code 0.
    ///
    /// # Errors
    /// As [`Client::set`].
    pub async fn close(mut self) -> Result<(), Error> {
        self.single(|batch| Ok(batch.close()?)).await.map(|_| ())
    }
}

/// Takes what SUMO says until it says no more.
async fn listen(mut rx: ReadHalf<'_>, inbox: &mut Vec<u8>) -> Error {
    loop {
        inbox.reserve(INBOX_BYTES);
        match rx.read_buf(inbox).await {
            Ok(0) => return Error::Disconnected(ErrorKind::UnexpectedEof.into()),
            Ok(_) => {}
            Err(error) => return Error::Disconnected(error),
        }
    }
}

/// Reads until a whole frame lies at `start`; gives its length.
async fn read_frame(stream: &mut TcpStream, inbox: &mut Vec<u8>, start: usize) -> Result<usize, Error> {
    loop {
        let missing = match frame_length(&inbox[start..])? {
            Some(length) if inbox.len() - start >= length => return Ok(length),
            Some(length) => start + length - inbox.len(),
            None => 4,
        };
        inbox.reserve(missing.min(INBOX_BYTES));
        if stream.read_buf(inbox).await.map_err(Error::Disconnected)? == 0 {
            return Err(Error::Disconnected(IoError::from(ErrorKind::UnexpectedEof)));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::net::SocketAddr;

    use tokio::net::TcpListener;

    use super::super::variables::vehicle;
    use super::*;

    const LIMIT: Duration = Duration::from_millis(300);
    const STEPPED: [u8; 15] = [0, 0, 0, 15, 7, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0];

    /// A peer that greets as SUMO does, then answers the next request with the given pieces and hangs up.
    async fn peer(pieces: Vec<Vec<u8>>) -> SocketAddr {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        tokio::spawn(async move {
            let (mut stream, _) = listener.accept().await.unwrap();
            let mut request = [0; 4096];
            stream.read_exact(&mut request[..6]).await.unwrap();
            let version = b"\0\0\0\x20\x07\0\0\0\0\0\0\x15\0\0\0\0\x16\0\0\0\x0bSUMO 1.28.0";
            stream.write_all(version).await.unwrap();
            assert!(stream.read(&mut request).await.unwrap() > 0);
            for piece in pieces {
                stream.write_all(&piece).await.unwrap();
                stream.flush().await.unwrap();
                sleep(Duration::from_millis(1)).await;
            }
        });
        address
    }

    #[tokio::test]
    async fn an_answer_may_come_in_any_pieces() {
        let mut client = Client::connect(peer(STEPPED.map(|byte| vec![byte]).to_vec()).await, LIMIT).await.unwrap();
        assert_eq!((client.version().api, client.version().number), (22, (1, 28, 0)));
        assert_eq!(client.step().await.unwrap().block_count(), 0);
    }

    #[tokio::test]
    async fn two_answers_may_come_in_one_piece() {
        let value = [b"\x07\xa4\0\0\0\0\0\x11\xb4\x40\0\0\0\x01a\x0b".as_slice(), &3f64.to_be_bytes()].concat();
        let second = [&[0, 0, 0, 28], value.as_slice()].concat();
        let mut client = Client::connect(peer(vec![[&STEPPED[..], &second].concat()]).await, LIMIT).await.unwrap();
        let (mut first, mut gets) = (Batch::new(), Batch::new());
        first.step().unwrap();
        let speed = gets.get(vehicle::SPEED, "a").unwrap();
        let (stepped, got) = (client.queue(&first).unwrap(), client.queue(&gets).unwrap());
        assert_eq!(client.receive(got).await.unwrap().get(speed).unwrap(), 3.0, "the later answer first");
        assert_eq!(client.receive(stepped).await.unwrap().len(), 1, "the earlier one was kept");
        assert!(client.pending.is_empty() && client.commands.is_empty());
    }

    #[tokio::test]
    async fn a_ticket_is_good_for_one_answer_of_its_own_client() {
        let mut client = Client::connect(peer(vec![STEPPED.to_vec()]).await, LIMIT).await.unwrap();
        let mut other = Client::connect(peer(vec![STEPPED.to_vec()]).await, LIMIT).await.unwrap();
        let mut step = Batch::new();
        step.step().unwrap();
        let (ticket, others) = (client.send(&step).await.unwrap(), other.send(&step).await.unwrap());
        assert!(matches!(client.receive(others).await, Err(Error::Empty)));
        assert_eq!(client.receive(ticket).await.unwrap().len(), 1);
    }

    #[tokio::test]
    async fn the_answer_goes_with_its_ticket() {
        let refused = [b"\0\0\0\x0f\x0b\xc4\xff\0\0\0\x04gone".as_slice(), &STEPPED, &STEPPED].concat();
        let mut client = Client::connect(peer(vec![refused]).await, LIMIT).await.unwrap();
        let (mut speeds, mut step) = (Batch::new(), Batch::new());
        speeds.set_speed(&super::super::Prefix::new("a").unwrap(), 1.0).unwrap();
        step.step().unwrap();
        let told = client.send(&speeds).await.unwrap();
        drop(client.send(&step).await.unwrap());
        assert_eq!(client.pending.len(), 2);
        assert_eq!(client.receive(told).await.unwrap().refusal(0).unwrap().text, "gone");
        assert_eq!(client.exchange(&step).await.unwrap().block_count(), 0, "the answer to the first step is dropped");
        assert!(client.pending.is_empty());
        assert!(matches!(client.send(&Batch::new()).await, Err(Error::Empty)));
        assert!(client.pending.is_empty(), "nothing of it was sent");
    }

    #[tokio::test]
    async fn a_bad_answer_finishes_the_client() {
        let cut = STEPPED[..9].to_vec();
        let short = vec![0, 0, 0, 3];
        let more = [&STEPPED[..], &[0]].concat();
        let huge = vec![0x7f, 0xff, 0xff, 0xff, 7, 2];
        for (answer, bad_bytes) in [(cut, false), (short, true), (more, true), (huge, true)] {
            let mut client = Client::connect(peer(vec![answer]).await, LIMIT).await.unwrap();
            let error = client.step().await.unwrap_err();
            assert_eq!(matches!(error, Error::Decode(_)), bad_bytes, "{error}");
            assert!(bad_bytes || matches!(error, Error::Disconnected(_)), "{error}");
            assert!(client.inbox.capacity() <= 2 * INBOX_BYTES, "a length alone makes nothing grow");
            assert!(matches!(client.step().await, Err(Error::Finished)));
        }
    }

    #[tokio::test]
    async fn dropping_a_call_midway_finishes_the_client() {
        let mut client = Client::connect(peer(vec![vec![0]]).await, LIMIT).await.unwrap();
        assert!(timeout(Duration::ZERO, client.step()).await.is_err());
        assert!(matches!(client.step().await, Err(Error::Finished)));
    }
}
