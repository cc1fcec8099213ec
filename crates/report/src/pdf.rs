//! A scene as a PDF of one page, with its fonts.

use super::font::Weight;
use super::scene::{Anchor, Mark, Pen, Scene, Xy};
use pdf_writer::types::{CidFontType, FontFlags, LineCapStyle, LineJoinStyle, SystemInfo};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::BTreeMap;

/// Opacities are states of the page; one per percent that is used.
type States = BTreeMap<u32, String>;

pub fn file(scene: &Scene, title: &str) -> Vec<u8> {
    let mut pdf = Pdf::new();
    let mut ids = (1..).map(Ref::new);
    let mut next = || ids.next().unwrap_or(Ref::new(1));
    let [catalog, pages, page, contents, info] = [next(), next(), next(), next(), next()];
    let fonts = Weight::ALL.map(|weight| (weight, next()));
    let (states, drawing) = draw(scene);

    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    pdf.document_info(info).title(TextStr(title)).producer(TextStr("piaffe"));
    pdf.stream(contents, &drawing);
    let mut writer = pdf.page(page);
    writer.media_box(Rect::new(0.0, 0.0, scene.width as f32, scene.height as f32)).parent(pages).contents(contents);
    let mut resources = writer.resources();
    let mut dictionary = resources.fonts();
    for (weight, id) in fonts {
        dictionary.pair(font_name(weight), id);
    }
    dictionary.finish();
    let mut dictionary = resources.ext_g_states();
    for (percent, name) in &states {
        let opacity = *percent as f32 / 100.0;
        dictionary
            .insert(Name(name.as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState>()
            .stroking_alpha(opacity)
            .non_stroking_alpha(opacity);
    }
    dictionary.finish();
    resources.finish();
    writer.finish();
    for (weight, id) in fonts {
        embed(&mut pdf, weight, [id, next(), next(), next(), next()]);
    }
    pdf.finish()
}

fn font_name(weight: Weight) -> Name<'static> {
    match weight {
        Weight::Regular => Name(b"R"),
        Weight::Bold => Name(b"B"),
    }
}

/// Marks as drawing operators, and the states that they use.
fn draw(scene: &Scene) -> (States, Vec<u8>) {
    let mut states = States::new();
    let mut c = Content::new();
    let flip = |[x, y]: Xy| [x as f32, (scene.height - y) as f32];
    c.set_line_cap(LineCapStyle::RoundCap).set_line_join(LineJoinStyle::RoundJoin);
    for mark in &scene.marks {
        let opacity = match mark {
            Mark::Line { pen, .. } => pen.opacity,
            Mark::Area { opacity, .. } | Mark::Dot { opacity, .. } => *opacity,
            Mark::Text { .. } => 1.0,
        };
        let percent = (opacity * 100.0).round() as u32;
        let state = states.entry(percent).or_insert_with(|| format!("a{percent}"));
        c.set_parameters(Name(state.as_bytes()));
        match mark {
            Mark::Line { points, pen } => {
                stroke(&mut c, pen);
                path(&mut c, points, flip);
                c.stroke();
            }
            Mark::Area { points, ink, .. } => {
                let [r, g, b] = ink.rgb();
                c.set_fill_rgb(r, g, b);
                path(&mut c, points, flip);
                c.close_path().fill_nonzero();
            }
            Mark::Dot { at, radius, ink, .. } => {
                // A line of no length with round ends is a disc.
                stroke(&mut c, &Pen::new(*ink, 2.0 * radius));
                path(&mut c, &[*at, *at], flip);
                c.stroke();
            }
            Mark::Text { at, text, size, weight, anchor, ink } => {
                let shift = match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5,
                    Anchor::End => 1.0,
                };
                let [r, g, b] = ink.rgb();
                let [x, y] = flip([at[0] - shift * weight.width(text, *size), at[1]]);
                let face = weight.face();
                let glyphs: Vec<u8> = text.chars().flat_map(|c| face.glyph(c).to_be_bytes()).collect();
                c.set_fill_rgb(r, g, b);
                c.begin_text().set_font(font_name(*weight), *size as f32).next_line(x, y);
                c.show(Str(&glyphs)).end_text();
            }
        }
    }
    (states, c.finish().to_vec())
}

fn stroke(c: &mut Content, pen: &Pen) {
    let [r, g, b] = pen.ink.rgb();
    c.set_stroke_rgb(r, g, b).set_line_width(pen.width as f32);
    c.set_dash_pattern(pen.dash.pattern().into_iter().flatten().map(|x| x as f32), 0.0);
}

fn path(c: &mut Content, points: &[Xy], flip: impl Fn(Xy) -> [f32; 2]) {
    for (k, point) in points.iter().enumerate() {
        let [x, y] = flip(*point);
        if k == 0 {
            c.move_to(x, y)
        } else {
            c.line_to(x, y)
        };
    }
}

/// A font by its glyph numbers, with the characters that they stand for, so that text can be searched and copied.
fn embed(pdf: &mut Pdf, weight: Weight, [font, descendant, descriptor, file, characters]: [Ref; 5]) {
    let face = weight.face();
    let name = format!("Inter-{}", if weight == Weight::Bold { "SemiBold" } else { "Regular" });
    let name = Name(name.as_bytes());
    let system = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
    let scale = 1000.0 / face.units_per_em as f32;
    pdf.type0_font(font)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(descendant)
        .to_unicode(characters);
    let mut cid = pdf.cid_font(descendant);
    cid.subtype(CidFontType::Type0).base_font(name).system_info(system).font_descriptor(descriptor);
    cid.widths().consecutive(0, face.advances.iter().map(|advance| f32::from(*advance) * scale));
    cid.finish();
    let edge = |x: i16| f32::from(x) * scale;
    let [left, lower, right, upper] = face.bounds.map(edge);
    pdf.font_descriptor(descriptor)
        .name(name)
        .flags(FontFlags::NON_SYMBOLIC)
        .bbox(Rect::new(left, lower, right, upper))
        .italic_angle(0.0)
        .ascent(edge(face.ascender))
        .descent(edge(face.descender))
        .cap_height(edge(face.capital_height))
        .stem_v(80.0)
        .font_file3(file);
    pdf.stream(file, weight.bytes()).pair(Name(b"Subtype"), Name(b"OpenType"));
    let mut map = pdf_writer::types::UnicodeCmap::new(Name(b"Glyphs"), system);
    for (c, glyph) in &face.glyphs {
        map.pair(*glyph, *c);
    }
    pdf.cmap(characters, &map.finish());
}
