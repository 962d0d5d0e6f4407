//! The layout on which the viewer opens: the scene and the events, the phases above the plots, the summary.
//!
//! Written out by hand and not by rerun's blueprint builder, whose ids are random.

use nalgebra::Vector3;
use rerun::{
    AsComponents, EntityPath,
    external::{
        re_log_types::BlueprintActivationCommand,
        re_sdk_types::blueprint::{
            archetypes::{
                Background, ContainerBlueprint, EntityBehavior, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend,
                ScalarAxis, TextLogColumns, TimePanelBlueprint, ViewBlueprint, ViewContents, ViewportBlueprint,
            },
            components::{BackgroundKind, ContainerKind, Corner2D, LoopMode, PanelState, PlayState, RootContainer},
            datatypes::{TextLogColumn, TextLogColumnKind},
        },
        uuid::Uuid,
    },
    log::LogMsg,
};

use super::{
    entity::{TIMELINE, entity},
    error::RecordError,
    input::RecordingInput,
    messages::Messages,
    palette,
    plots::{FAILURE, JOINTS_SHOWN, LIMIT, LOAD, PLOTS, hardest_first, top},
    scene::POINTS,
};
use crate::model::verdict::CheckKind;

/// A view or a container with its share of its parent's room.
struct Placed {
    id: Uuid,
    path: EntityPath,
    share: f32,
}

/// Counts the views and containers: their numbers are their ids.
struct Layout {
    messages: Messages,
    count: u128,
}

/// The layout's messages; the last one activates it.
pub(super) fn messages(messages: Messages, input: &RecordingInput) -> Result<Vec<LogMsg>, RecordError> {
    let mut layout = Layout { messages, count: 0 };
    let left = [layout.scene(input)?, layout.events()?];
    let left = layout.container(ContainerKind::Vertical, &left, 0.48)?;
    let mut middle = vec![layout.view("StateTimeline", "phases", &["+ /phases"], 0.12)?];
    for (plot, kind) in PLOTS {
        middle.push(layout.plot(input, plot, kind)?);
    }
    middle.push(layout.load()?);
    let middle = layout.container(ContainerKind::Vertical, &middle, 0.28)?;
    let right = layout.view("TextDocument", "summary", &["+ /summary"], 0.24)?;
    let root = layout.container(ContainerKind::Horizontal, &[left, middle, right], 1.0)?;
    layout.panels(root.id)?;
    let activation = BlueprintActivationCommand::make_active(layout.messages.store_id().clone());
    let mut messages = layout.messages.into_messages();
    messages.push(LogMsg::BlueprintActivationCommand(activation));
    Ok(messages)
}

impl Layout {
    fn log(&mut self, path: &EntityPath, what: &dyn AsComponents) -> Result<(), RecordError> {
        self.messages.log_static(path, what)
    }

    /// A place for a view or a container, numbered by the count of those before it.
    fn place(&mut self, kind: &str, share: f32) -> Placed {
        let id = Uuid::from_u128(self.count);
        self.count += 1;
        Placed { id, path: entity(&[kind, &id.to_string()]), share }
    }

    /// A view of what the queries match.
    fn view<Q: AsRef<str>>(
        &mut self,
        class: &str,
        name: &str,
        queries: &[Q],
        share: f32,
    ) -> Result<Placed, RecordError> {
        let view = self.place("view", share);
        let contents = ViewContents::new(queries.iter().map(|query| query.as_ref()));
        self.log(&child(&view.path, "ViewContents"), &contents)?;
        let style = ViewBlueprint::new(class).with_display_name(name).with_space_origin("/");
        self.log(&view.path, &style)?;
        Ok(view)
    }

    fn container(&mut self, kind: ContainerKind, contents: &[Placed], share: f32) -> Result<Placed, RecordError> {
        let placed = self.place("container", share);
        let shares = contents.iter().map(|placed| placed.share);
        let container =
            ContainerBlueprint::new(kind).with_contents(contents.iter().map(|placed| placed.path.to_string()));
        let container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares),
            _ => container.with_row_shares(shares),
        };
        self.log(&placed.path, &container)?;
        Ok(placed)
    }

    /// The scene: robot, board and person in profile.
    fn scene(&mut self, input: &RecordingInput) -> Result<Placed, RecordError> {
        let view = self.view("3D", "scene", &["+ /scene/**"], 0.76)?;
        let (eye, target) = eye_and_target(input);
        let controls = EyeControls3D::new()
            .with_position(point(&eye))
            .with_look_target(point(&target))
            .with_eye_up([0.0, 0.0, 1.0]);
        self.log(&child(&view.path, "EyeControls3D"), &controls)?;
        let floor = rerun::components::Plane3D::new([0.0, 0.0, 1.0], input.robot.floor_z_m as f32);
        self.log(&child(&view.path, "LineGrid3D"), &LineGrid3D::new().with_plane(floor))?;
        let background = Background::new(BackgroundKind::SolidColor).with_color(palette::background());
        self.log(&child(&view.path, "Background"), &background)?;
        for whose in ["person", "robot"] {
            let points = entity(&["scene", POINTS, whose]);
            let overrides = ViewContents::blueprint_base_visualizer_path_for_entity(view.id, &points);
            self.log(&overrides, &EntityBehavior::new().with_visible(false))?;
        }
        Ok(view)
    }

    /// Time, level and text; all events have the same entity.
    fn events(&mut self) -> Result<Placed, RecordError> {
        let view = self.view("TextLog", "events", &["+ /events"], 0.24)?;
        let column = |kind| TextLogColumn { kind, visible: true.into() };
        let columns = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body].map(column);
        self.log(&child(&view.path, "TextLogColumns"), &TextLogColumns::new().with_text_log_columns(columns))?;
        Ok(view)
    }

    fn plot(&mut self, input: &RecordingInput, plot: &str, kind: CheckKind) -> Result<Placed, RecordError> {
        let unit = kind.unit();
        let (name, queries) = match kind {
            CheckKind::TorqueRatio => {
                let joints = hardest_first(input);
                let mut queries: Vec<String> =
                    joints.iter().take(JOINTS_SHOWN).map(|(joint, _)| query(plot, &joint.name)).collect();
                queries.extend([query(plot, LIMIT), query(plot, FAILURE)]);
                ("joint torque / limit, hardest joints".to_owned(), queries)
            }
            CheckKind::SlipRotation => (format!("rotation of the hands on the board, {unit}"), vec![query(plot, "**")]),
            CheckKind::Slip => (format!("slip of the hands on the board, {unit}"), vec![query(plot, "**")]),
            _ => (format!("{plot} of the tool point, {unit}"), vec![query(plot, "**")]),
        };
        let view = self.view("TimeSeries", &name, &queries, 0.19)?;
        self.legend(&view)?;
        self.range(&view, top(input, kind))?;
        Ok(view)
    }

    /// The load that acts.
    fn load(&mut self) -> Result<Placed, RecordError> {
        let view = self.view("TimeSeries", "load factor", &[query(LOAD, "**")], 0.12)?;
        self.legend(&view)?;
        Ok(view)
    }

    fn legend(&mut self, view: &Placed) -> Result<(), RecordError> {
        self.log(&child(&view.path, "PlotLegend"), &PlotLegend::new().with_corner(Corner2D::LeftTop))
    }

    /// The axis from zero to `top`.
    fn range(&mut self, view: &Placed, top: f64) -> Result<(), RecordError> {
        let range = rerun::datatypes::Range1D([0.0, top]);
        self.log(&child(&view.path, "ScalarAxis"), &ScalarAxis::new().with_range(range))
    }

    fn panels(&mut self, root_id: Uuid) -> Result<(), RecordError> {
        let root = RootContainer(rerun::datatypes::Uuid::from(root_id));
        let viewport =
            ViewportBlueprint::new().with_root_container(root).with_auto_layout(false).with_auto_views(false);
        self.log(&entity(&["viewport"]), &viewport)?;
        for panel in ["blueprint_panel", "selection_panel"] {
            self.log(&entity(&[panel]), &PanelBlueprint::new().with_state(PanelState::Collapsed))?;
        }
        let time = TimePanelBlueprint::new()
            .with_state(PanelState::Collapsed)
            .with_timeline(TIMELINE)
            .with_play_state(PlayState::Playing)
            .with_loop_mode(LoopMode::All);
        self.log(&entity(&["time_panel"]), &time)
    }
}

fn child(path: &EntityPath, name: &str) -> EntityPath {
    path.join(&entity(&[name]))
}

/// The query for one series of a plot, or for all of them.
fn query(plot: &str, series: &str) -> String {
    match series {
        "**" => format!("+ {}/**", entity(&["plots", plot])),
        _ => format!("+ {}", entity(&["plots", plot, series])),
    }
}

/// From where the scene is seen and what is looked at, in W: robot, board and person in profile, from the side to which the
/// worked face looks, and from far enough to have all three in view.
fn eye_and_target(input: &RecordingInput) -> (Vector3<f64>, Vector3<f64>) {
    let board = input.plan.object.x_wo;
    let robot = Vector3::zeros();
    // Without a person the place in front of the board is shown.
    let person = input.plan.human.map_or(board.translation.vector + Vector3::x() * 0.6, |human| {
        human.x_wb.translation.vector + Vector3::z() * (0.6 * human.height_m)
    });
    let apart = person - robot;
    let side = Vector3::z().cross(&apart).normalize();
    let face_w = board.rotation * Vector3::z();
    let side = if side.dot(&face_w) < 0.0 { -side } else { side };
    let target = (2.0 * board.translation.vector + person + robot) / 4.0;
    let span_m = apart.norm().max(0.8);
    (target + side * (1.45 * span_m) + apart * 0.25 + Vector3::z() * (0.45 * span_m), target)
}

fn point(vector: &Vector3<f64>) -> [f32; 3] {
    vector.map(|v| v as f32).into()
}
