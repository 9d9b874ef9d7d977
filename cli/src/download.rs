//! Downloads of stored tables: in chunks, some at once, verified, and resumed after an interrupted download.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::ops::Range;
use std::os::unix::fs::FileExt as _;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context, bail};
use bytes::Bytes;
use drillsweep_api::{ArtifactEntry, ProblemKind};
use futures::StreamExt as _;
use reqwest::header::{ACCEPT_ENCODING, IF_RANGE, RANGE};
use reqwest::{Method, StatusCode};

use crate::client::{Answer, Client, PATIENCE, RETRY_PAUSE, is_worth_another_try};

/// Bytes of a request.
const CHUNK: u64 = 4 << 20;

/// Requests at once: a line with a long round trip is filled, and a server serves others.
const REQUESTS: usize = 4;

impl Client {
    /// Downloads a stored table to a file, or returns the problem that the server answers in its place. Until it is whole it has the
    /// further ending `part`, and received bytes are kept.
    ///
    /// # Errors
    /// The server does not answer for a while or refuses all files, or the file cannot be written.
    pub(crate) fn stored_table(
        &self,
        entry: &ArtifactEntry,
        file: &Path,
    ) -> anyhow::Result<Result<(), String>> {
        self.in_chunks(entry, file, CHUNK)
    }

    fn in_chunks(
        &self,
        entry: &ArtifactEntry,
        file: &Path,
        chunk: u64,
    ) -> anyhow::Result<Result<(), String>> {
        let part = file.with_added_extension("part");
        let unwritten = || format!("cannot write {}", part.display());
        let mut sink = OpenOptions::new().create(true).append(true).open(&part).with_context(unwritten)?;
        let begun = sink.metadata().with_context(unwritten)?.len();
        if begun > 0 && !self.goes_on_with(entry, &part, begun)? {
            sink.set_len(0).with_context(unwritten)?;
        }
        let start = sink.metadata().with_context(unwritten)?.len();
        let ranges = (start..entry.bytes)
            .step_by(usize::try_from(chunk)?)
            .map(|from| from..entry.bytes.min(from + chunk));
        let mut pieces =
            futures::stream::iter(ranges.map(|range| self.range(entry, range))).buffered(REQUESTS);
        let received = self.block_on(async {
            while let Some(piece) = pieces.next().await {
                match piece? {
                    Ok(bytes) => sink.write_all(&bytes).with_context(unwritten)?,
                    Err(problem) => return Ok(Err(problem)),
                }
            }
            anyhow::Ok(Ok(()))
        })?;
        if let Err(problem) = received {
            return Ok(Err(problem));
        }
        drop(sink);
        if hash(&part)? != entry.hash {
            std::fs::remove_file(&part).with_context(unwritten)?;
            return Ok(Err("the file differs from that of the server; fetch again".to_owned()));
        }
        std::fs::rename(&part, file).with_context(|| format!("cannot write {}", file.display()))?;
        Ok(Ok(()))
    }

    /// Returns true if the remains of an earlier download are the beginning of the table: its last bytes are those of the server.
    fn goes_on_with(&self, entry: &ArtifactEntry, part: &Path, length: u64) -> anyhow::Result<bool> {
        /// Bytes that are compared; other differences show in the hash of the whole.
        const COMPARED: u64 = 4096;
        if length > entry.bytes {
            return Ok(false);
        }
        let from = length.saturating_sub(COMPARED);
        let mut known = vec![0; usize::try_from(length - from)?];
        let read = File::open(part).and_then(|file| file.read_exact_at(&mut known, from));
        read.with_context(|| format!("cannot read {}", part.display()))?;
        Ok(self.block_on(self.range(entry, from..length))?.is_ok_and(|last| last == known))
    }

    /// Reads some bytes of a stored table, or the problem that the server answers with in their place.
    async fn range(&self, entry: &ArtifactEntry, range: Range<u64>) -> anyhow::Result<Result<Bytes, String>> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let request = self
                .prepare(Method::GET, &entry.link)
                // Compressed answers have no ranges.
                .header(ACCEPT_ENCODING, "identity")
                .header(RANGE, format!("bytes={}-{}", range.start, range.end - 1))
                .header(IF_RANGE, format!("\"{}\"", entry.hash));
            let answer = self.answer(request, &entry.link).await;
            // Recomputing takes minutes, and other tables are there.
            let is_recomputed = answer.as_ref().is_ok_and(|answer| answer.is_of(ProblemKind::Recomputing));
            if !is_recomputed && is_worth_another_try(answer.as_ref()) && Instant::now() < deadline {
                let wait = answer.ok().and_then(|answer| answer.retry_after());
                tokio::time::sleep(wait.unwrap_or(RETRY_PAUSE)).await;
                continue;
            }
            let Answer { status, body, .. } = match answer? {
                answer if answer.refuses_all() => bail!("{}: {}", entry.link, answer.problem()),
                answer if !answer.status.is_success() => return Ok(Err(answer.problem())),
                answer => answer,
            };
            if status != StatusCode::PARTIAL_CONTENT || body.len() as u64 != range.end - range.start {
                return Ok(Err("it was replaced during the download; fetch again".to_owned()));
            }
            return Ok(Ok(body));
        }
    }
}

/// BLAKE3 hash of a file's content.
fn hash(path: &Path) -> anyhow::Result<String> {
    let read = || blake3::Hasher::new().update_reader(File::open(path)?).map(|hasher| hasher.finalize());
    let hash: std::io::Result<blake3::Hash> = read();
    Ok(hash.with_context(|| format!("cannot read {}", path.display()))?.to_hex().to_string())
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader};
    use std::net::{TcpListener, TcpStream};
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Arc, Mutex};
    use std::time::Duration;

    use super::*;
    use crate::client::ServerArguments;

    /// Fate of a request at a server, by the request's number.
    type Behaviour = fn(usize) -> Fate;

    #[derive(Clone, Copy)]
    enum Fate {
        Answer,
        /// Breaks off in the middle of the body.
        BreakOff,
        /// Refuses for the time being.
        Busy,
        /// Has another table by now.
        Replaced,
    }

    /// A server with one table.
    struct Server {
        address: String,
        served: Arc<Mutex<Vec<Range<u64>>>>,
        most_at_once: Arc<AtomicUsize>,
    }

    fn content() -> Vec<u8> {
        (0..100_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect()
    }

    fn entry() -> ArtifactEntry {
        let content = content();
        ArtifactEntry {
            name: "history".to_owned(),
            media_type: "application/vnd.apache.parquet".to_owned(),
            bytes: content.len() as u64,
            rows: 1,
            hash: blake3::hash(&content).to_hex().to_string(),
            expired: None,
            link: "/history".to_owned(),
        }
    }

    impl Server {
        fn start(behaviour: Behaviour) -> Server {
            let listener = TcpListener::bind("127.0.0.1:0").unwrap();
            let address = listener.local_addr().unwrap().to_string();
            let (served, most_at_once) = (Arc::<Mutex<Vec<_>>>::default(), Arc::<AtomicUsize>::default());
            let (seen, most) = (served.clone(), most_at_once.clone());
            let (requests, open) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
            std::thread::spawn(move || {
                for stream in listener.incoming() {
                    let (seen, most) = (seen.clone(), most.clone());
                    let (requests, open) = (requests.clone(), open.clone());
                    std::thread::spawn(move || {
                        most.fetch_max(open.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        let fate = behaviour(requests.fetch_add(1, Ordering::SeqCst));
                        serve(stream.unwrap(), fate, &open, &seen);
                    });
                }
            });
            Server { address, served, most_at_once }
        }

        fn client(&self) -> Client {
            Client::new(&ServerArguments { server: self.address.clone() }).unwrap()
        }
    }

    /// Answers one of the open requests, and enters the range that is sent into `seen`.
    fn serve(mut stream: TcpStream, fate: Fate, open: &AtomicUsize, seen: &Mutex<Vec<Range<u64>>>) {
        let lines = BufReader::new(stream.try_clone().unwrap()).lines().map(Result::unwrap);
        let head: Vec<String> = lines.take_while(|line| !line.is_empty()).collect();
        let range = head.iter().find_map(|line| line.strip_prefix("range: bytes=")).unwrap();
        let (first, last) = range.split_once('-').unwrap();
        let range = first.parse::<u64>().unwrap()..last.parse::<u64>().unwrap() + 1;
        let content = content();
        let body = &content[range.start as usize..range.end as usize];
        let (status, body, sent) = match fate {
            Fate::Answer => ("206 Partial Content", body, body.len()),
            Fate::BreakOff => ("206 Partial Content", body, body.len() / 2),
            Fate::Busy => ("503 Service Unavailable\r\nretry-after: 0", &b"{}"[..], 2),
            Fate::Replaced => ("200 OK", &b"another"[..], 7),
        };
        // Long enough for others to come.
        std::thread::sleep(Duration::from_millis(20));
        // Before the client, which has its answer, sends its next request.
        open.fetch_sub(1, Ordering::SeqCst);
        if matches!(fate, Fate::Answer) {
            seen.lock().unwrap().push(range);
        }
        let head =
            format!("HTTP/1.1 {status}\r\ncontent-length: {}\r\nconnection: close\r\n\r\n", body.len());
        stream.write_all(head.as_bytes()).unwrap();
        stream.write_all(&body[..sent]).unwrap();
    }

    #[test]
    fn a_table_comes_whole_over_a_line_that_breaks_off() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("history.parquet");
        let server = Server::start(|number| match number {
            2 => Fate::Busy,
            5 => Fate::BreakOff,
            _ => Fate::Answer,
        });
        server.client().in_chunks(&entry(), &file, 8_000).unwrap().unwrap();
        assert_eq!(std::fs::read(&file).unwrap(), content());
        let most = server.most_at_once.load(Ordering::SeqCst);
        assert!((2..=REQUESTS).contains(&most), "{most} requests at once");
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_download_resumes_if_the_table_is_unchanged() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("history.parquet");
        let part = file.with_added_extension("part");
        let read = |before: &[u8]| {
            std::fs::write(&part, before).unwrap();
            let server = Server::start(|_| Fate::Answer);
            server.client().in_chunks(&entry(), &file, 8_000).unwrap().unwrap();
            assert_eq!(std::fs::read(&file).unwrap(), content());
            let served = server.served.lock().unwrap();
            served.iter().map(|range| range.end - range.start).sum::<u64>()
        };
        // The last of what is there is read again.
        assert_eq!(read(&content()[..60_000]), 40_000 + 4_096);
        assert_eq!(read(&content()), 4_096);
        assert_eq!(read(&[7; 60_000]), 100_000 + 4_096);
        assert_eq!(read(&[7; 100_001]), 100_000);
    }

    #[test]
    fn other_bytes_are_a_problem_and_leave_no_file() {
        let directory = tempfile::tempdir().unwrap();
        let file = directory.path().join("history.parquet");
        let part = file.with_added_extension("part");
        let replaced = Server::start(|number| if number == 3 { Fate::Replaced } else { Fate::Answer });
        let problem = replaced.client().in_chunks(&entry(), &file, 8_000).unwrap().unwrap_err();
        assert!(problem.contains("replaced"), "{problem}");
        // Its end is that of the table, its beginning is not.
        let mut damaged = content();
        damaged[10] ^= 1;
        std::fs::write(&part, damaged).unwrap();
        let server = Server::start(|_| Fate::Answer);
        let problem = server.client().in_chunks(&entry(), &file, 8_000).unwrap().unwrap_err();
        assert!(problem.contains("differs from that of the server"), "{problem}");
        assert!(!file.exists() && !part.exists());
    }
}
