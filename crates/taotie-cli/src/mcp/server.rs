//! The server: answers the requests of a client, one call with heavy work at a time.

// Newer versions of the protocol deprecate roots, but have no replacement for them, and all clients send them.
#![expect(deprecated, reason = "roots")]

use super::arguments::{CommandLine, Written};
use super::child::{self, Done, Listener};
use super::folders::Folders;
use super::tools::{Subcommand, tools};
use crate::console;
use crate::lines::Line;
use anyhow::{Context, Result, bail};
use rmcp::model::{
    CallToolRequestParams, CallToolResponse, CallToolResult, ContentBlock, Implementation, InputRequest,
    InputRequiredResult, InputResponses, JsonObject, ListRootsRequest, ListRootsResult, ListToolsResult,
    PaginatedRequestParams, ProgressNotificationParam, ProgressToken, ProtocolVersion, ServerCapabilities,
    ServerConfig,
};
use rmcp::service::RequestContext;
use rmcp::{ErrorData, Peer, RoleServer, ServerHandler};
use serde_json::Value;
use std::time::Duration;
use tokio::sync::Semaphore;

const INSTRUCTIONS: &str = "Taotie bakes high-poly scans (.gltf, .glb, .obj, .ply, .stl, .fbx) to small glTF assets, renders \
    them, and measures in degrees how close they are. Paths are absolute, or relative to the first allowed folder. \
    `bake` and `verify` report a verdict with the value of each requirement: state these figures, not impressions of \
    the pictures.";

/// Time for a client to list its roots.
const PATIENCE: Duration = Duration::from_secs(10);

/// Most items of a list in a result; the report has all.
const MOST_ITEMS: usize = 100;

/// Most bytes of a text in a result.
const MOST_TEXT: usize = 20_000;

/// Parts of a report that a result leaves out: details of the measurement, trials of a search, times of stages.
const LEFT_OUT: [&str; 3] = ["proof", "trials", "stages"];

/// The key of the roots in requests for input.
const ROOTS: &str = "roots";

/// A server for one client.
pub struct Server {
    /// The folders of the command line.
    folders: Folders,
    /// Held by a call with heavy work, which uses all threads and most of the memory.
    turn: Semaphore,
}

impl Server {
    /// Creates a server for files in these folders.
    pub fn new(folders: Folders) -> Self {
        Self { folders, turn: Semaphore::new(1) }
    }

    /// Returns the folders for a call, or the request for the client's roots that has to be answered first.
    async fn folders(
        &self,
        answers: Option<&InputResponses>,
        context: &RequestContext<RoleServer>,
    ) -> Result<std::result::Result<Folders, InputRequiredResult>> {
        if context.client_capabilities().is_none_or(|client| client.roots.is_none()) {
            return Ok(Ok(self.folders.clone()));
        }
        let asks_in_result =
            context.protocol_version().is_some_and(|version| version >= ProtocolVersion::V_2026_07_28);
        let listed = match answers.and_then(|answers| answers.get(ROOTS)) {
            _ if !asks_in_result => asked(context).await?,
            Some(answer) => serde_json::from_value(answer.clone()).context("invalid list of roots")?,
            None => {
                let request = InputRequest::ListRoots(ListRootsRequest::default());
                return Ok(Err(InputRequiredResult::from_input_requests([(ROOTS.into(), request)].into())));
            }
        };
        let uris: Vec<&str> = listed.roots.iter().map(|root| root.uri.as_str()).collect();
        Ok(Ok(self.folders.of_roots(&uris)))
    }

    /// Runs a tool.
    async fn run(
        &self,
        tool: &Subcommand,
        request: CallToolRequestParams,
        context: &RequestContext<RoleServer>,
    ) -> Result<CallToolResponse> {
        let folders = match self.folders(request.input_responses.as_ref(), context).await? {
            Ok(folders) => folders,
            Err(required) => return Ok(required.into()),
        };
        // The process finds no files by relative paths.
        let place = tempfile::Builder::new().prefix(".taotie-mcp-").tempdir()?;
        let given = request.arguments.unwrap_or_default();
        let line = CommandLine::of(tool, &given, (&folders, place.path()))?;
        let _turn = match tool.is_light {
            true => None,
            false => tokio::select! {
                turn = self.turn.acquire() => Some(turn?),
                () = context.ct.cancelled() => bail!("cancelled"),
            },
        };
        let mut listener = Notifier::of(context);
        let done = child::run(&line.arguments, place.path(), &mut listener, context.ct.cancelled()).await?;
        Ok(result(done.context("cancelled")?, line.written.as_ref())?.into())
    }
}

/// Asks the client for its roots.
async fn asked(context: &RequestContext<RoleServer>) -> Result<ListRootsResult> {
    let answer = tokio::time::timeout(PATIENCE, context.peer.list_roots()).await;
    answer.context("the client does not answer roots/list")?.context("the client's roots are unknown")
}

/// Notifies the client of progress, if it wants to be notified.
struct Notifier {
    peer: Peer<RoleServer>,
    token: Option<ProgressToken>,
    /// The running stage, and the number of stages before it.
    stage: Option<String>,
    before: f64,
    /// The last value, which may only grow.
    last: f64,
}

impl Notifier {
    fn of(context: &RequestContext<RoleServer>) -> Self {
        let token = context.meta.get_progress_token();
        Self { peer: context.peer.clone(), token, stage: None, before: -1.0, last: 0.0 }
    }
}

impl Listener for Notifier {
    /// Counts stages: in the middle of the third one, progress is 2.5. Their number is unknown.
    async fn hear(&mut self, stage: &str, fraction: f64) {
        let Some(token) = &self.token else { return };
        if self.stage.as_deref() != Some(stage) {
            self.before += 1.0;
            self.stage = Some(stage.to_owned());
        }
        let now = self.before + fraction.clamp(0.0, 1.0);
        if now > self.last {
            self.last = now;
            let message = format!("{stage}: {:.0} %", fraction * 100.0);
            let progress = ProgressNotificationParam::new(token.clone(), now).with_message(message);
            // The client may have gone; then the call is cancelled.
            let _ = self.peer.notify_progress(progress).await;
        }
    }
}

/// Returns the result of a process: its report as text and as structured content, and its pictures.
///
/// # Errors
/// If it failed; the message is its own.
fn result(done: Done, written: Option<&Written>) -> Result<CallToolResult> {
    if !matches!(done.code, Some(0 | 1)) {
        bail!("{}", failure(&done));
    }
    let report: JsonObject = serde_json::from_slice(&done.json).context("invalid report")?;
    let mut content = Vec::new();
    for line in done.lines {
        match line {
            Line::Text(mut text) => {
                shorten_text(&mut text);
                content.insert(0, ContentBlock::text(text));
            }
            Line::Picture { caption, mime, data } => {
                content.extend([ContentBlock::text(caption), ContentBlock::image(data, mime)]);
            }
            // Warnings are in the report.
            Line::Message(_) => {}
        }
    }
    let mut result = CallToolResult::success(content);
    result.structured_content = Some(shown(report, written));
    Ok(result)
}

/// Returns the message of a failed process, without the program's name.
fn failure(done: &Done) -> String {
    let messages = done.lines.iter().filter_map(|line| match line {
        Line::Message(message) => Some(message.as_str()),
        _ => None,
    });
    let error = messages.clone().find_map(|message| message.strip_prefix("taotie: error: "));
    match (error, done.code) {
        (Some(error), _) => error.to_owned(),
        (None, Some(code)) => format!("exit code {code}: {}", messages.collect::<Vec<_>>().join("\n")),
        (None, None) => "the process was killed, perhaps because memory ran out; try --memory-limit".into(),
    }
}

/// Returns the report as shown to clients: without its longest parts, and with the absolute paths of the files
/// that were written.
fn shown(mut report: JsonObject, written: Option<&Written>) -> Value {
    report.retain(|key, _| !LEFT_OUT.contains(&key.as_str()));
    if let Some(Value::Array(files)) = report.get_mut("files") {
        files.retain_mut(|file| match (written, file.as_str()) {
            (Some(written), Some(name)) => {
                *file = written.path(name).display().to_string().into();
                true
            }
            _ => false,
        });
    }
    let mut report = Value::Object(report);
    shorten(&mut report);
    report
}

/// Shortens long lists; the last item states how many were left out.
fn shorten(value: &mut Value) {
    match value {
        Value::Array(items) => {
            let more = items.len().saturating_sub(MOST_ITEMS);
            items.truncate(MOST_ITEMS);
            items.iter_mut().for_each(shorten);
            if more > 0 {
                items.push(format!("{more} more").into());
            }
        }
        Value::Object(members) => members.values_mut().for_each(shorten),
        Value::String(text) => shorten_text(text),
        _ => {}
    }
}

fn shorten_text(text: &mut String) {
    if text.len() > MOST_TEXT {
        let end = (0..=MOST_TEXT).rev().find(|end| text.is_char_boundary(*end));
        text.truncate(end.unwrap_or(0));
        text.push_str("\n…");
    }
}

impl ServerHandler for Server {
    fn get_info(&self) -> ServerConfig {
        ServerConfig::new(ServerCapabilities::builder().enable_tools().build())
            .with_server_info(Implementation::new("taotie", env!("CARGO_PKG_VERSION")))
            .with_instructions(INSTRUCTIONS)
    }

    async fn list_tools(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> std::result::Result<ListToolsResult, ErrorData> {
        Ok(ListToolsResult::with_all_items(tools()))
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        context: RequestContext<RoleServer>,
    ) -> std::result::Result<CallToolResponse, ErrorData> {
        let Some(tool) = Subcommand::named(&request.name) else {
            return Err(ErrorData::invalid_params(format!("unknown tool `{}`", request.name), None));
        };
        Ok(self.run(tool, request, &context).await.unwrap_or_else(|error| {
            CallToolResult::error(vec![ContentBlock::text(console::causes(&error))]).into()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn done(code: Option<i32>, lines: &[&str]) -> Done {
        let lines = lines.iter().map(|line| Line::Message((*line).into())).collect();
        Done { code, json: br#"{ "files": ["a.png"], "proof": 1 }"#.to_vec(), lines }
    }

    #[test]
    fn failures_have_the_message_of_the_program() {
        let why = |done: Done| result(done, None).unwrap_err().to_string();
        assert_eq!(why(done(Some(2), &["reading", "taotie: error: a.obj: broken"])), "a.obj: broken");
        assert_eq!(why(done(Some(101), &["a", "b"])), "exit code 101: a\nb");
        assert!(why(done(None, &[])).contains("killed"));
        assert!(why(Done { json: Vec::new(), ..done(Some(0), &[]) }).contains("invalid report"));
    }

    #[test]
    fn a_requirement_that_is_not_met_is_a_result() {
        let written = Written { folder: "/in".into(), named: Vec::new() };
        let shown = result(done(Some(1), &["warning"]), Some(&written)).unwrap();
        assert_eq!(
            (shown.is_error, shown.structured_content),
            (Some(false), Some(json!({ "files": ["/in/a.png"] })))
        );
        let shown = result(done(Some(0), &[]), None).unwrap();
        assert_eq!(shown.structured_content, Some(json!({ "files": [] })), "temporary files are not listed");
    }

    #[test]
    fn long_results_are_shortened() {
        let mut value = json!({ "a": vec![1; 250], "b": "é".repeat(MOST_TEXT), "c": ["short"] });
        shorten(&mut value);
        assert_eq!((value["a"].as_array().unwrap().len(), &value["a"][100]), (101, &json!("150 more")));
        assert!(value["b"].as_str().unwrap().len() < MOST_TEXT + 5 && value["c"] == json!(["short"]));
    }
}
