//! What those with tools of their own are given: the WebSocket's address, layouts.

use std::fs;

use ferntast_msgs::interface::{self, Base, Library};
use ferntast_tests::{Session, refused, run};

#[test]
fn foxglove_is_for_this_host_only() {
    let session = Session::new();
    refused(
        &session,
        &["session", "--foxglove=0.0.0.0:8765"],
        &["0.0.0.0:8765", "127.0.0.1:8765", "ssh -L"],
    );
}

/// Whether `field`, such as `pose.position.x`, stands in a message of `interface`.
fn has_field(library: &Library, interface: &str, fields: &[&str]) -> bool {
    let Some((first, rest)) = fields.split_first() else {
        return true;
    };
    // position[2] is an element of position.
    let first = first.split('[').next().unwrap_or(first);
    let definition = library.definition(interface).expect("built in");
    let found = definition.fields.iter().find(|field| field.name == first);
    found.is_some_and(|field| match &field.kind.base {
        Base::Interface(inner) => has_field(library, inner, rest),
        _ => rest.is_empty(),
    })
}

/// Whether a text in a layout is a topic, with or without a field: not the end of an XML element.
fn is_path(word: &str) -> bool {
    word.starts_with('/') && !word.contains(['<', '>'])
}

#[test]
fn the_layouts_show_what_there_is() {
    let session = Session::new();
    let interfaces = run(&session, &["interfaces", "--json"]).success().json();
    let library = interface::library().expect("built in");
    let folder = ferntast_tests::root().join("config/layouts");
    let mut shown = 0;
    for name in ["foxglove.json", "plotjuggler.xml"] {
        let text = fs::read_to_string(folder.join(name)).expect(name);
        for word in text.split('"').filter(|word| is_path(word)) {
            let topics = interfaces["topics"].as_array().expect("topics");
            let topic = topics.iter().find_map(|topic| {
                let rest = word.strip_prefix(topic["name"].as_str()?)?;
                let ends = rest.is_empty() || rest.starts_with(['.', '/']);
                ends.then(|| (topic["type"].as_str(), rest))
            });
            let (interface, rest) = topic.unwrap_or_else(|| panic!("{name}: no topic {word}"));
            let fields: Vec<&str> = rest.split(['.', '/']).filter(|f| !f.is_empty()).collect();
            let found = has_field(&library, interface.expect("a type"), &fields);
            assert!(found, "{name}: no field {word}");
            shown += 1;
        }
    }
    assert!(shown > 20, "{shown}");
}
