//! The report as one HTML file: nothing in it is loaded from elsewhere.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::published::{BANDWIDTH, GPU};
use super::report::{DeviceFigures, Measured, Outcome, Report, SceneReport};
use super::scenes::Likeness;
use super::{figures, tables};
use crate::sizes::count;

const STYLE: &str = include_str!("page.css");

pub(super) fn html(report: &Report) -> anyhow::Result<String> {
    let figures = figures::all(report)?;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "kdray beside SAH KD-Tree Construction on GPU" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                (head(report))
                (scenes(report))
                (all_tables(report))
                section {
                    h2 { "Figures" }
                    div .figures { @for figure in &figures { (figure) } }
                }
            }
        }
    };
    Ok(page.into_string())
}

fn head(report: &Report) -> Markup {
    let machine = &report.machine;
    html! {
        header {
            h1 { "kdray beside the paper" }
            p {
                "The scenes, tables and figures of Wu, Zhao and Liu, "
                cite { "SAH KD-Tree Construction on GPU" }
                " (High Performance Graphics 2011), as kdray " (report.version) " has them. "
                "The paper's GPU is a " (GPU) " with " (BANDWIDTH) " GB/s."
            }
            p {
                (report.date) "; CPU: " (machine.cpu) ", " (threads(machine.threads)) ", "
                (machine.system) "; passes: " (report.passes) ", the best of which counts. Made by"
            }
            pre { (report.command) }
            (device(report.device.as_ref()))
        }
    }
}

fn threads(threads: usize) -> String {
    if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") }
}

fn device(device: Option<&DeviceFigures>) -> Markup {
    html! {
        @match device {
            None => p .note {
                "Nothing was built on a GPU. With " code { "--device gpu" }
                " the report has its stages, bytes, buckets and clipped references too."
            },
            Some(device) => {
                p { "GPU builder on " (device.adapter) ", " (device.driver) "." }
                @if device.is_software {
                    p .note {
                        strong { "That is a software device" } ", a program on the CPU: its times "
                        "say nothing of a GPU's and stand beside none of the paper's. Bytes, "
                        "dispatches, memory and floors are the same on every device."
                    }
                }
            }
        }
    }
}

fn scenes(report: &Report) -> Markup {
    html! {
        section {
            h2 { "Scenes" }
            div .scenes { @for scene in &report.scenes { (card(report, scene)) } }
            p .small {
                "Pictures are traced by kdray through the trees that the tables are about."
            }
        }
    }
}

fn card(report: &Report, scene: &SceneReport) -> Markup {
    html! {
        figure .scene {
            @match &scene.outcome {
                Outcome::Missing { wanted } => {
                    div .missing { "missing: no " (wanted) " in " (report.meshes) }
                    figcaption { strong { (scene.title) } }
                }
                Outcome::Measured(measured) => {
                    img alt=(format!("A picture of {}", scene.title)) src={
                        "data:image/png;base64," (BASE64_STANDARD.encode(&measured.png))
                    };
                    figcaption { strong { (scene.title) } (likeness(measured)) }
                }
            }
        }
    }
}

/// How many triangles, and whose.
fn likeness(measured: &Measured) -> Markup {
    let triangles = count(measured.tree.triangles);
    html! {
        ", " (triangles) " triangles"
        @match measured.likeness {
            Likeness::Same => {}
            Likeness::Revision => { "; " em { "a revision" } ": " (measured.what) }
            Likeness::Substitute => { "; " em { "a substitute" } ": " (measured.what) }
        }
    }
}

fn all_tables(report: &Report) -> Markup {
    let is_software = report.device.as_ref().is_some_and(|device| device.is_software);
    html! {
        section {
            h2 { "Tables" }
            p .small {
                "A star marks a mesh that is not the paper's: its row is there to be read, not to "
                "be compared. Choi: kd-trees without clipping on 32 cores. Lauterbach: bounding "
                "volume hierarchies by SAH on a GPU."
            }
            h3 { "Build and trace" }
            (tables::speed(report))
            p .small {
                "kdray traces the closest hits of 1024 x 1024 camera rays, on the CPU; the paper's "
                "times are those it gives for its pictures of that size, seen from elsewhere."
            }
            h3 { "Memory" }
            (tables::memory(report))
            @if report.device.is_some() {
                h3 { "Work of the build on the GPU" }
                (tables::work(report))
                p .small {
                    "The floor is the time in which the paper's bandwidth moves these bytes: no "
                    "build can be faster there, and none need be as fast."
                }
                h3 { "Rays on the GPU" }
                (tables::rays(report))
                (about_rays(report, is_software))
            }
            h3 { "Trees" }
            (tables::trees(report))
            @if is_software {
                h3 { "Times on the software device" }
                (tables::software(report))
                p .small { "Not comparable with any other time on this page, nor with the paper's." }
            }
        }
    }
}

fn about_rays(report: &Report, is_software: bool) -> Markup {
    let private = report.on_gpu().next().map(|(_, gpu)| gpu.rays.private_bytes);
    html! {
        p .small {
            "The closest hits of the same rays, in the same run, with their way to the GPU and back."
            @if is_software { " The GPU is a program on this CPU." }
            @if let Some([walk, locate]) = private {
                " A ray has " (walk) " bytes of memory for itself on its way, and " (locate)
                " while it is worked out where it hits."
            }
        }
    }
}
