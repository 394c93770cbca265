use super::*;

const READABLE: &str = r#"{
  "tyndall": 1,
  "about": "a \"cloud\" at noon",
  "nodes": {
    "sun": { "type": "sun", "irradiance": [20, 18.5, 1e-7], "direction": [0.3, -0.4, -0.0] },
    "medium": {
      "type": "medium",
      "g": 3.0,
      "emission": { "flame": "flame" },
      "nothing": null,
      "albedo": {
        "keys": [
          [1, 0.5],
          [8, [1, 0.5, 0]]
        ]
      },
      "empty": {},
      "list": []
    }
  },
  "wires": [
    "sun.light -> medium.lights"
  ],
  "layout": {
    "sun": [0, -10.5]
  }
}
"#;

fn error(text: &str) -> String {
    let parsed = Document::parse(text, Path::new(""));
    parsed.expect_err("a mistake").to_string()
}

/// The message for a graph that is right but for `nodes` and what follows.
fn error_in(rest: &str) -> String {
    error(&format!(r#"{{"tyndall": 1, {rest}}}"#))
}

#[test]
fn round_trip_keeps_text() {
    let document = Document::parse(READABLE, Path::new("here")).unwrap();
    assert_eq!(document.to_json(), READABLE);
    assert_eq!(document.base, Path::new("here"));
    assert_eq!(document.layout["sun"], [0.0, -10.5]);
    assert_eq!(document.wires[0].to.port, "lights");
}

#[test]
fn what_is_too_wide_has_an_entry_a_line() {
    let text = |n_letters: usize| {
        let about = "x".repeat(n_letters);
        let text =
            format!(r#"{{"tyndall": 1, "nodes": {{"a": {{"type": "t", "b": "{about}"}}}}, "wires": []}}"#);
        Document::parse(&text, Path::new("")).unwrap().to_json()
    };
    let widest = |text: &str| text.lines().map(str::len).max();
    // 33 letters, blanks among them, are no x.
    assert_eq!((widest(&text(87)), text(87).lines().count()), (Some(120), 7));
    assert_eq!(text(88).lines().count(), 10);
}

#[test]
fn type_may_stand_anywhere_and_order_is_kept() {
    let text = r#"{"nodes": {"b": {"z": 1, "type": "t", "a": 2}, "a": {"type": "t"}}, "tyndall": 1}"#;
    let document = Document::parse(text, Path::new("")).unwrap();
    let params: Vec<&str> = document.nodes["b"].params.keys().map(String::as_str).collect();
    assert_eq!(params, ["z", "a"]);
    assert_eq!(document.paths().join(", "), "b, a");
    let again = Document::parse(&document.to_json(), Path::new("")).unwrap();
    assert_eq!(again, document);
}

#[test]
fn wires_do_not_mind_blanks() {
    let wire: Wire = " a.x->  b.y ".parse().unwrap();
    assert_eq!(wire.to_string(), "a.x -> b.y");
    for wrong in ["", "a.x", "a.x -> b", "a.x b.y", "a.x -> b.y.z", "a. -> b.y"] {
        assert!(wrong.parse::<Wire>().is_err(), "{wrong}");
    }
}

#[test]
fn syntax_and_names_given_twice() {
    assert_eq!(error("{"), "the graph is not valid JSON: EOF while parsing an object at line 1 column 1");
    assert_eq!(
        error("{\"tyndall\": 1} x"),
        "the graph is not valid JSON: trailing characters at line 1 column 16"
    );
    assert_eq!(
        error_in(r#""nodes": {"a": {"type": "t"}, "a": {"type": "t"}}"#),
        "the graph is not valid JSON: 'nodes.a' is given twice; keep one at line 1 column 48"
    );
    assert_eq!(
        error_in("\"nodes\": {\"a\": {\"type\": \"t\",\n\"g\": 1, \"g\": 1}}"),
        "the graph is not valid JSON: 'nodes.a.g' is given twice; keep one at line 2 column 11"
    );
    assert_eq!(
        error_in(r#""nodes": {"a": {"type": "t", "x": 1e999}}"#),
        "the graph is not valid JSON: number out of range at line 1 column 54"
    );
}

#[test]
fn versions() {
    assert_eq!(
        error(r#"{"nodes": {}}"#),
        "this is no graph: the field \"tyndall\" is missing; write \"tyndall\": 1"
    );
    for wrong in ["0", "1.5", "-1", "\"1\""] {
        assert_eq!(
            error(&format!(r#"{{"tyndall": {wrong}, "nodes": {{}}}}"#)),
            format!("the version \"tyndall\" is {wrong}; write a whole number from 1 to 1")
        );
    }
    assert_eq!(
        error(r#"{"tyndall": 2, "nodes": {}}"#),
        "the graph is of version 2, this program reads up to 1; use a later one"
    );
}

#[test]
fn migrations_run_from_the_version_of_the_file_on() {
    let steps: [Migration; 2] = [
        |root| drop(root.insert("one".to_owned(), Json::Null)),
        |root| drop(root.insert("two".to_owned(), Json::Null)),
    ];
    let migrated = |version: u64| {
        let mut root = Map::from_iter([("tyndall".to_owned(), version.into())]);
        migrate(&mut root, &steps).map(|()| root.keys().skip(1).cloned().collect::<Vec<_>>())
    };
    assert_eq!(migrated(1).unwrap(), ["one", "two"]);
    assert_eq!(migrated(2).unwrap(), ["two"]);
    assert!(migrated(3).unwrap().is_empty());
    assert!(migrated(4).is_err());
}

#[test]
fn every_field_says_its_form() {
    assert_eq!(error("[1]"), "the graph is [1]; write an object");
    assert_eq!(error(r#"{"tyndall": 1}"#), "the field \"nodes\" is missing; write \"nodes\": {}");
    assert_eq!(
        error_in(r#""nodes": {}, "wire": [], "about": 3, "wires": {}, "layout": []"#),
        "unknown field 'wire'; did you mean 'wires'? allowed are tyndall, about, nodes, \
         wires, layout, bends, frames, inputs, outputs\n\
         about is 3; write a string\n\
         wires is {}; write a list of wires\n\
         layout is []; write an object of [x, y]"
    );
    assert_eq!(error_in(r#""nodes": 1"#), "nodes is 1; write an object of nodes by name");
    assert_eq!(
        error_in(r#""nodes": {"a b": {"type": "t"}, "c": 1, "d": {"type": 1}, "e": {}}"#),
        "'a b' is no name of a node; write letters, digits, '_' and '-'\n\
         nodes.c is 1; write an object\n\
         nodes.d.type is 1; write a string\n\
         nodes.e has no \"type\"; 'tyndall nodes' lists them"
    );
    assert_eq!(
        error_in(
            r#""nodes": {"sun": {"type": "t"}}, "wires": ["a -> b", 1], "layout": {"sin": [0, 0], "sun": [0]}"#
        ),
        "wires[0] is \"a -> b\"; write \"node.output -> node.input\"\n\
         wires[1] is 1; write \"node.output -> node.input\"\n\
         layout.sun is [0]; write [x, y]\n\
         layout.sin is the place of no node; did you mean 'sun'? remove it or add the node"
    );
}

#[test]
fn a_missing_file_names_itself() {
    let error = Document::load(Path::new("no/such.json")).unwrap_err();
    let text = error.to_string();
    assert!(text.starts_with("cannot read the graph 'no/such.json': "), "{text}");
}

#[test]
fn truth_graphs_parse_and_round_trip() {
    let Some(dir) = crate::shared_dir() else {
        eprintln!("skipped: no shared files");
        return;
    };
    let dir = dir.join("truth");
    let entries = std::fs::read_dir(&dir).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let graphs: Vec<PathBuf> = paths.filter(|path| path.to_string_lossy().ends_with(".graph.json")).collect();
    assert!(!graphs.is_empty());
    for path in graphs {
        let document = Document::load(&path).unwrap();
        assert_eq!(document.base, dir);
        assert!(document.nodes.len() > 5 && document.wires.len() > 5);
        let again = Document::parse(&document.to_json(), &dir).unwrap();
        assert_eq!(again, document, "{}", path.display());
    }
}

const GROUPED: &str = r#"{
  "tyndall": 1,
  "nodes": {
    "sky": { "type": "environment", "mute": true, "scale": 2 },
    "look": {
      "type": "group",
      "bypass": true,
      "about": "what it is for",
      "nodes": {
        "a": { "type": "sum" },
        "b": { "type": "sum" }
      },
      "wires": [
        "a.light -> b.lights"
      ],
      "inputs": {
        "light": "a.lights",
        "both": [
          "a.lights",
          "b.lights"
        ]
      },
      "outputs": { "light": "b.light" },
      "layout": {
        "a": [0, 0]
      },
      "bends": {
        "a.light -> b.lights": [
          [10, 20.5]
        ]
      },
      "frames": [
        { "title": "inside", "at": [0, 0], "size": [10, 10] }
      ]
    }
  },
  "wires": [
    "sky.light -> look.light"
  ],
  "bends": {
    "sky.light -> look.light": [
      [1, 2],
      [3, 4]
    ]
  },
  "frames": [
    { "title": "a \"comment\"", "at": [-10, 0], "size": [200, 100], "color": [0.5, 0, 1] }
  ]
}
"#;

#[test]
fn groups_frames_and_bends_round_trip() {
    let document = Document::parse(GROUPED, Path::new("graphs")).unwrap();
    assert_eq!(document.to_json(), GROUPED);
    assert_eq!(document.paths(), ["sky", "look", "look/a", "look/b"]);
    assert!(document.node("sky").unwrap().mute && document.node("look").unwrap().bypass);
    assert_eq!(document.inside("look").unwrap().inputs["both"].len(), 2);
    assert_eq!(document.node("look/a").unwrap().type_id, "sum");
    assert!(document.node("look/c").is_none() && document.node("sky/a").is_none());
}

/// A saved value that came back one unit in the last place off would make every result stale.
#[test]
fn numbers_come_back_as_they_were() {
    let mut document = Document::default();
    // Weyl's sequence, turned to 52 bits.
    let numbers = (1..=1000_u64).map(|idx| (idx.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / 9e13);
    let numbers: Vec<Json> = numbers.map(Json::from).collect();
    let node = Node { params: Map::from_iter([("x".to_owned(), Json::Array(numbers))]), ..Node::new("t") };
    document.nodes.insert("a".to_owned(), node);
    assert_eq!(Document::parse(&document.to_json(), Path::new("")).unwrap(), document);
}

#[test]
fn groups_frames_and_bends_say_their_form() {
    assert_eq!(
        error_in(
            r#""nodes": {"a": {"type": "t", "mute": 1}, "g": {"type": "group", "layot": {}, "wires": [1],
                "inputs": {"x": "a", "y": [], "a.b": "c.d"}}},
               "bends": {"a": [[0, 0]], "a.x -> g.x": [[0]], "a.y -> g.y": [[0, 0]]}"#
        ),
        "nodes.a.mute is 1; write true or false\n\
         the field \"nodes.g.nodes\" is missing; write \"nodes\": {}\n\
         unknown field 'nodes.g.layot'; did you mean 'layout'? allowed are type, mute, bypass, about, nodes, \
         wires, layout, bends, frames, inputs, outputs\n\
         nodes.g.wires[0] is 1; write \"node.output -> node.input\"\n\
         nodes.g.inputs.x is \"a\"; write \"node.input\", or a list of them\n\
         nodes.g.inputs.y is []; write \"node.input\", or a list of them\n\
         'nodes.g.a.b' is no name of a port; write letters, digits, '_' and '-'\n\
         bends is \"a\"; write a wire before the ':', \"node.output -> node.input\"\n\
         bends.\"a.x -> g.x\" is [[0]]; write a list of [x, y], at least one\n\
         bends.\"a.y -> g.y\" are the bends of no wire; remove them or add the wire"
    );
    assert_eq!(
        error_in(
            r#""nodes": {"sun": {"type": "t"}}, "inputs": {"x": "sin.x"}, "outputs": {"y": "moon.y", "z": 1}"#
        ),
        "outputs.z is 1; write \"node.output\"\n\
         inputs.x stands for 'sin.x' of no node; did you mean 'sun'? remove it or add the node\n\
         outputs.y stands for 'moon.y' of no node; remove it or add the node"
    );
    assert_eq!(
        error_in(
            r#""nodes": {}, "frames": [1, {}, {"title": 1, "at": [0], "size": [0, 1], "color": [2, 0, 0], "sise": 1}]"#
        ),
        "frames[0] is 1; write {\"title\": \"..\", \"at\": [x, y], \"size\": [width, height]}\n\
         frames[1] has no \"at\"; write \"at\": [x, y]\n\
         frames[1] has no \"size\"; write \"size\": [x, y]\n\
         frames[2].title is 1; write a string\n\
         frames[2].at is [0]; write [x, y]\n\
         frames[2].size is [0,1]; write [width, height], both above 0\n\
         frames[2].color is [2,0,0]; write [red, green, blue], each 0..=1\n\
         unknown field 'frames[2].sise'; did you mean 'size'? allowed are title, at, size, color"
    );
}

#[test]
fn names_are_made_from_any_text() {
    for (text, name) in [("Wölkchen", "Wölkchen"), ("a b/c.d-e_1", "a_b_c_d-e_1"), ("", "_"), (" ", "_")] {
        assert_eq!(node_name_from(text), name);
        assert!(is_node_name(name), "{name}");
    }
}

#[test]
fn a_later_version_opens_with_what_is_understood() {
    let open = |text: &str| Document::open_leniently(text, Path::new("")).unwrap();
    let (document, left_out) = open(
        r#"{"tyndall": 3, "nodes": {"a": {"type": "t", "x": 1}, "b": 1}, "clouds": [], "layout": {"a": [0, 1],
            "b": [0, 1]}, "wires": ["a.x -> a.y", "a.x => a.y"], "frames": [{"title": "here"}]}"#,
    );
    assert_eq!(
        left_out,
        [
            "the graph is of version 3, this program reads up to 1; what it does not know is left out",
            "nodes.b is 1; write an object",
            "unknown field 'clouds'; allowed are tyndall, about, nodes, wires, layout, bends, frames, inputs, \
             outputs",
            "wires[1] is \"a.x => a.y\"; write \"node.output -> node.input\"",
            "frames[0] has no \"at\"; write \"at\": [x, y]",
            "frames[0] has no \"size\"; write \"size\": [x, y]",
            "layout.b is the place of no node; remove it or add the node",
        ]
    );
    assert_eq!((document.nodes.len(), document.wires.len(), document.layout.len()), (1, 1, 1));
    assert!(document.frames.is_empty());
    // What was opened so can be written and read strictly.
    assert_eq!(Document::parse(&document.to_json(), Path::new("")).unwrap(), document);
    let (document, left_out) = open(GROUPED);
    assert!(left_out.is_empty());
    assert_eq!(document.to_json(), GROUPED);
    let refused = |text: &str| Document::open_leniently(text, Path::new("")).unwrap_err().to_string();
    assert_eq!(refused("[]"), "the graph is []; write an object");
    assert_eq!(
        refused(r#"{"nodes": {}}"#),
        "this is no graph: the field \"tyndall\" is missing; write \"tyndall\": 1"
    );
}
