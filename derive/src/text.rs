//! The `.msg` text of a message of ferntast's own.

use crate::{declaration::Declaration, field::Kind};

/// Spaces before a comment, after the longest field.
const GAP: usize = 3;

/// The text.
pub fn msg(declaration: &Declaration) -> String {
    let lines: Vec<(String, String)> = declaration
        .fields
        .iter()
        .filter(|field| !field.local)
        .map(|field| {
            let comment = plain(&field.docs.join(" "));
            match field.kind {
                Kind::Stamp => (
                    format!("{} header", field.msg_type()),
                    format!("stamp: {comment}; frame_id is empty"),
                ),
                _ => (format!("{} {}", field.msg_type(), field.wire_name), comment),
            }
        })
        .collect();
    let longest = lines.iter().map(|(line, _)| line.len()).max().unwrap_or(0);
    let column = declaration.comment_column.unwrap_or(longest + GAP);
    let mut text = String::new();
    for line in &declaration.docs {
        text.push_str(&format!("# {}\n", plain(line)));
    }
    text.push('\n');
    let shown = declaration.fields.iter().filter(|field| !field.local);
    for (field, (line, comment)) in shown.zip(&lines) {
        match &field.section {
            Some(Some(comment)) => text.push_str(&format!("\n# {comment}\n")),
            Some(None) => text.push('\n'),
            None => {}
        }
        match comment.is_empty() {
            true => text.push_str(line),
            false => text.push_str(&format!("{line:column$}# {comment}")),
        }
        text.push('\n');
    }
    text
}

/// A comment without the escapes of rustdoc.
fn plain(comment: &str) -> String {
    comment.replace("\\[", "[").replace("\\]", "]")
}
