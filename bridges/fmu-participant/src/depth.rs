//! Nesting depth of XML elements, found without recursion. The XML parser recurses into elements,
//! so that the depth is checked before parsing.

/// Start and end marks of text that is not an element.
const SKIPPED: [(&str, &str); 4] =
    [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>"), ("<!", ">")];

/// Returns the maximum nesting depth of elements, up to the first place where the text is no valid
/// XML.
#[must_use]
pub fn deepest(text: &str) -> usize {
    let (mut depth, mut most) = (0_usize, 0);
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        rest = &rest[at..];
        let skipped = SKIPPED.iter().find(|(begin, _)| rest.starts_with(begin));
        if let Some((begin, end)) = skipped {
            let inside = &rest[begin.len()..];
            let Some(length) = inside.find(end) else { break };
            rest = &inside[length + end.len()..];
            continue;
        }
        let (tag, after) = rest.split_at(tag_length(rest));
        if tag.starts_with("</") {
            depth = depth.saturating_sub(1);
        } else if !tag.ends_with("/>") {
            depth += 1;
            most = most.max(depth);
        }
        rest = after;
    }
    most
}

/// Returns the length of the tag at the start of `text`. A `>` within quotes does not end the tag.
fn tag_length(text: &str) -> usize {
    let mut quote = None;
    for (place, byte) in text.bytes().enumerate() {
        match (byte, quote) {
            (b'>', None) => return place + 1,
            (b'"' | b'\'', None) => quote = Some(byte),
            (byte, Some(open)) if byte == open => quote = None,
            _ => {}
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_element_does_not_count() {
        assert_eq!(deepest("<?xml version='1.0'?><a><b x='/>'/><b><c/></b><b></b></a>"), 2);
        assert_eq!(
            deepest("<!DOCTYPE a><a><!-- </a></a> <b> --><b><![CDATA[</b><c>]]></b></a>"),
            2
        );
        assert_eq!(deepest("<a x=\"'>\"><b y='<'></b></a>"), 2);
        assert_eq!(deepest("no xml"), 0);
        assert_eq!(deepest(&"<a>".repeat(1000)), 1000);
    }

    fn node_depth(node: roxmltree::Node<'_, '_>) -> usize {
        let inside = node.children().filter(roxmltree::Node::is_element);
        1 + inside.map(node_depth).max().unwrap_or(0)
    }

    proptest! {
        /// The depth found is an upper bound of the depth of any valid XML. An empty element adds
        /// no depth.
        #[test]
        fn no_text_is_deeper_than_found(pieces in prop::collection::vec(
            prop::sample::select(vec!["<a>", "</a>", "<a/>", "<a x='>'>", "<!--", "-->", "<![CDATA[", "]]>", "x", "\"", "<?p", "?>"]),
            0..24,
        )) {
            let text = format!("<r>{}</r>", pieces.concat());
            if let Ok(document) = roxmltree::Document::parse(&text) {
                prop_assert!(node_depth(document.root_element()) <= deepest(&text) + 1, "{text}");
            }
        }
    }
}
