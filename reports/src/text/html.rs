//! A page in Markdown as HTML: tables, figures, headings to which links lead.

use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html::push_html};

/// Converts a text. `leads` returns the target of a link or a figure; where it returns none, the text stands alone.
pub(crate) fn html(text: &str, leads: &dyn Fn(&str) -> Option<String>) -> String {
    let events: Vec<Event> = Parser::new_ext(text, Options::ENABLE_TABLES).collect();
    let mut kept = Vec::new();
    // True for each open link that leads somewhere.
    let mut open = Vec::new();
    for (n, event) in events.iter().enumerate() {
        match event {
            Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
                let to = leads(dest_url);
                open.push(to.is_some());
                kept.extend(to.map(|to| {
                    let (dest_url, title) = (CowStr::from(to), title.clone());
                    Event::Start(Tag::Link { link_type: *link_type, dest_url, title, id: id.clone() })
                }));
            }
            Event::End(TagEnd::Link) => kept.extend(open.pop().unwrap_or(true).then(|| event.clone())),
            Event::Start(Tag::Heading { level, classes, attrs, .. }) => {
                let id = Some(CowStr::from(anchor(&events[n + 1..])));
                let (level, classes, attrs) = (*level, classes.clone(), attrs.clone());
                kept.push(Event::Start(Tag::Heading { level, id, classes, attrs }));
            }
            // A wide one scrolls in a box of its own.
            Event::Start(Tag::Table(_)) => {
                kept.extend([Event::Html("<div class=\"scroll\">".into()), event.clone()]);
            }
            Event::End(TagEnd::Table) => kept.extend([event.clone(), Event::Html("</div>".into())]),
            event => kept.push(event.clone()),
        }
    }
    let mut page = String::new();
    push_html(&mut page, kept.into_iter());
    page
}

/// Returns the name of a heading to which links lead: its words in small letters, joined by dashes.
fn anchor(events: &[Event]) -> String {
    let inside = events.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Heading(_))));
    let words = inside.filter_map(|event| match event {
        Event::Text(text) | Event::Code(text) => Some(text.to_lowercase()),
        _ => None,
    });
    let words: String = words.collect();
    words
        .chars()
        .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}
