//! Tree of a page that is well-formed XML.

/// Element of a page.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) index: usize,
    pub(super) name: String,
    pub(super) attributes: Vec<(String, String)>,
    pub(super) parent: Option<usize>,
    /// Names of all enclosing elements.
    pub(super) ancestors: Vec<String>,
    /// Text directly in the element.
    pub(super) text: String,
}

impl Element {
    pub(super) fn within(&self, name: &str) -> bool {
        self.ancestors.iter().any(|ancestor| ancestor == name)
    }

    pub(super) fn attribute(&self, name: &str) -> &str {
        let found = self.attributes.iter().find(|(other, _)| other == name);
        found.map_or("", |(_, value)| value.as_str())
    }

    pub(super) fn has_class(&self, class: &str) -> bool {
        self.attribute("class").split(' ').any(|other| other == class)
    }

    pub(super) fn numbers(&self, name: &str) -> Vec<f64> {
        let words = self.attribute(name).split(' ').filter(|word| !word.is_empty());
        words.map(|word| word.parse().unwrap()).collect()
    }

    /// Coordinates used by the element: ends of paths, corners of images, centres of circles,
    /// starts of texts.
    pub(super) fn places(&self) -> Vec<[f64; 2]> {
        let of = |name: &str| self.attribute(name).parse::<f64>().unwrap();
        match self.name.as_str() {
            "path" => path(self.attribute("d")),
            "circle" => vec![[of("cx"), of("cy")]],
            "image" => {
                let [x, y] = [of("x"), of("y")];
                vec![[x, y], [x + of("width"), y + of("height")]]
            }
            "text" if !self.attribute("x").is_empty() => vec![[of("x"), of("y")]],
            _ => Vec::new(),
        }
    }
}

/// Points of a path; supports the commands M, L, H, V, h and Z.
fn path(d: &str) -> Vec<[f64; 2]> {
    let mut places: Vec<[f64; 2]> = Vec::new();
    let mut rest = d;
    while let Some(command) = rest.chars().next() {
        let end = rest[1..].find(|c: char| c.is_ascii_alphabetic()).map_or(rest.len(), |n| n + 1);
        let numbers: Vec<f64> =
            rest[1..end].split_whitespace().map(|word| word.parse().unwrap()).collect();
        let last = places.last().copied();
        match (command, numbers.as_slice()) {
            ('M' | 'L', &[x, y]) => places.push([x, y]),
            ('H', &[x]) => places.push([x, last.unwrap()[1]]),
            ('h', &[x]) => places.push([last.unwrap()[0] + x, last.unwrap()[1]]),
            ('V', &[y]) => places.push([last.unwrap()[0], y]),
            ('Z', []) => {}
            _ => panic!("`{}` of `{d:.80}`", &rest[..end]),
        }
        rest = &rest[end..];
    }
    places
}

/// All elements of a page, in order. Panics if the page is not well-formed.
pub(super) fn elements(page: &str) -> Vec<Element> {
    let mut all: Vec<Element> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut rest = page.strip_prefix("<!DOCTYPE html>\n").expect("a document type");
    while let Some((text, tagged)) = rest.split_once('<') {
        if let Some(script) = tagged.strip_prefix("![CDATA[") {
            let (script, after) = script.split_once("]]>").expect("character data that end");
            all[*open.last().expect("data in an element")].text += script;
            rest = after;
            continue;
        }
        let (tag, after) = tagged.split_once('>').expect("a tag that ends");
        assert!(!text.contains('>'), "a bare > in `{text:.80}`");
        assert_entities(text);
        match open.last() {
            Some(element) => all[*element].text += text,
            None => assert!(text.trim().is_empty(), "text outside the page: {text:.80}"),
        }
        if let Some(name) = tag.strip_prefix('/') {
            let element = open.pop().unwrap_or_else(|| panic!("</{name}> closes nothing"));
            assert_eq!(all[element].name, name, "closed in the wrong order");
        } else {
            let (tag, closed) = tag.strip_suffix('/').map_or((tag, false), |tag| (tag, true));
            let name = tag.split([' ', '\n']).next().unwrap().to_owned();
            let attributes = attributes(&tag[name.len()..]);
            let ancestors = open.iter().map(|&n| all[n].name.clone()).collect();
            let (index, parent) = (all.len(), open.last().copied());
            let text = String::new();
            all.push(Element { index, name, attributes, parent, ancestors, text });
            if !closed {
                open.push(index);
            }
        }
        rest = after;
    }
    assert!(open.is_empty() && rest.trim().is_empty(), "not closed: {open:?}");
    all
}

fn attributes(text: &str) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (name, after) = rest.split_once("=\"").expect("a quoted attribute");
        let (value, after) = after.split_once('"').expect("a quote that ends");
        assert!(found.iter().all(|(other, _)| other != name), "{name} twice");
        assert_entities(value);
        found.push((name.to_owned(), value.to_owned()));
        rest = after.trim_start();
    }
    found
}

/// Asserts that every & starts an XML entity.
fn assert_entities(text: &str) {
    for after in text.split('&').skip(1) {
        let known = ["amp;", "lt;", "gt;", "quot;"].iter().any(|entity| after.starts_with(entity));
        assert!(known, "a bare & before `{after:.40}`");
    }
}

#[test]
fn what_is_not_well_formed_is_found() {
    let good = "<!DOCTYPE html>\n<html><p class=\"a b\">x &lt; 1<br/></p></html>";
    let all = elements(good);
    assert_eq!(all.len(), 3);
    assert!(all[1].has_class("b") && all[1].text == "x &lt; 1" && all[2].within("p"));
    for [from, to] in
        [["</p>", ""], ["&lt;", "&"], ["<br/>", "<br>"], ["a b\"", "a b\" class=\"\""]]
    {
        let bad = good.replace(from, to);
        assert!(std::panic::catch_unwind(|| elements(&bad)).is_err(), "{bad}");
    }
}
