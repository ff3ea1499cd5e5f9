fn main() {
    let path = std::env::args().nth(1).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let c = sdf_lang::compile(&path, &text, &Default::default());
    for d in &c.diagnostics {
        let (l, col) = c.sources.line_column(d.span.file, d.span.start);
        println!(
            "{} {}:{l}:{col} {} [{}] help: {:?}",
            d.code,
            c.sources.get(d.span.file).unwrap().name,
            d.message,
            d.label,
            d.help
        );
    }
    if let Some(s) = c.scene {
        println!("{}", s.program);
        println!("{:?}", s.summary);
    }
}
