//! Explanations of the codes of mistakes, for `karamelo-rs explain`.

use crate::script::diagnostic::Code;

/// The explanation of a code such as `E0203`, upper or lower case; `None` if there is no such code.
pub fn explain(code: &str) -> Option<String> {
    let code = Code::ALL.iter().find(|known| known.number().eq_ignore_ascii_case(code))?;
    let (_, explanation) = EXPLANATIONS.iter().find(|(explained, _)| explained == code)?;
    Some(format!("{}: {}\n\n{explanation}\n", code.number(), code.meaning()))
}

/// What each code means, with a wrong and a right example.
const EXPLANATIONS: &[(Code, &str)] = &[
    (
        Code::Encoding,
        "Scripts are UTF-8 text. A byte that belongs to no character usually comes from an editor\n\
         that saves in Latin-1 or UTF-16. Save the file as UTF-8.\n\
         wrong: the byte E9 for an accented letter\n\
         right: the bytes C3 A9",
    ),
    (
        Code::BadStatement,
        "A line is an assignment, a command call, or `quit` alone.\n\
         wrong: run_time 3.5\n\
         right: run_time(3.5)",
    ),
    (
        Code::BadName,
        "A variable name is a letter or `_`, then letters, digits, `_`.\n\
         wrong: 2R = 0.4\n\
         right: R2 = 0.4",
    ),
    (
        Code::MissingParenthesis,
        "A call goes on over line ends until its parenthesis closes. Here the next statement\n\
         begins, or the script ends, before that.\n\
         wrong: run_time(value(T)\n\
         right: run_time(value(T))",
    ),
    (
        Code::EmptyArgument,
        "Something must stand between two commas. `NULL` leaves a component alone.\n\
         wrong: fix(f, velocity_nodes, wall, , 0)\n\
         right: fix(f, velocity_nodes, wall, NULL, 0)",
    ),
    (
        Code::TrailingComma,
        "No comma stands before the closing parenthesis.\n\
         wrong: region(disk, cylinder, 0, 0, 0.2,)\n\
         right: region(disk, cylinder, 0, 0, 0.2)",
    ),
    (
        Code::TextAfterCall,
        "One statement per line; only a comment may follow its closing parenthesis.\n\
         wrong: set_dt(0.1) run(100)\n\
         right: set_dt(0.1)  # and on the next line run(100)",
    ),
    (
        Code::OpenQuote,
        "Double quotes open and close on one line.\n\
         wrong: save_plot(\"my plot.pdf)\n\
         right: save_plot(\"my plot.pdf\")",
    ),
    (
        Code::BrokenQuote,
        "Quotes make one word of what stands inside, so nothing stands beside them.\n\
         wrong: save_plot(my \"plot.pdf\")\n\
         right: save_plot(\"my plot.pdf\")",
    ),
    (
        Code::MissingExpression,
        "An operand, a function argument or the right side of `=` is missing.\n\
         wrong: a = 2*\n\
         right: a = 2*b",
    ),
    (
        Code::MissingOperator,
        "White space multiplies nothing; every product is written out.\n\
         wrong: circumference = 2 PI R\n\
         right: circumference = 2*PI*R",
    ),
    (
        Code::ComparisonChain,
        "A comparison gives 0 or 1, so a chain would compare that with the next number.\n\
         wrong: if(0 < x < 1, 1, 2)\n\
         right: if(0 < x && x < 1, 1, 2)",
    ),
    (
        Code::BadNumber,
        "Numbers look like 3, .5, 1., 1e3, 1E+3, 1.e-3.\n\
         wrong: rho = 1.000.0\n\
         right: rho = 1000.0",
    ),
    (
        Code::UnexpectedText,
        "This character or operator has no meaning at this place.\n\
         wrong: if(a = b, 1, 2)\n\
         right: if(a == b, 1, 2)",
    ),
    (
        Code::TooDeep,
        "Nesting and length of expressions have limits, so that no script exhausts the memory.\n\
         Name a part of the expression, or freeze a part of a formula as a number.\n\
         wrong: a = a + x, thousands of times\n\
         right: a = value(a) + 1",
    ),
    (
        Code::NotAvailable,
        "The word is reserved for something that this version does not have yet.\n\
         `karamelo-rs styles` lists what there is.\n\
         wrong: fix(f, meldtool, all)\n\
         right: fix(f, body_force, all, 0, -9.81)",
    ),
    (
        Code::UnknownCommand,
        "No command has this name. Upper and lower case differ.\n\
         wrong: runtime(3.5)\n\
         right: run_time(3.5)",
    ),
    (
        Code::UnknownStyle,
        "The family has no style of this name; `karamelo-rs styles material` lists its styles.\n\
         wrong: material(m, neohookean, rho, E, nu)\n\
         right: material(m, neo-hookean, rho, E, nu)",
    ),
    (
        Code::UnknownName,
        "A name must be defined above the line that uses it. Upper and lower case differ.\n\
         wrong: Rho = 1000, then material(m, linear, rho, E, nu)\n\
         right: rho = 1000, then material(m, linear, rho, E, nu)",
    ),
    (
        Code::Arity,
        "A command, style or function needs more arguments, or a function another number of them.\n\
         wrong: distance = hypot(x)\n\
         right: distance = hypot(x, y)",
    ),
    (
        Code::Unread,
        "Nothing reads this argument, so it would change nothing. Take it away, or look for a\n\
         comma too many.\n\
         wrong: run(100, 200)\n\
         right: run(100)",
    ),
    (
        Code::Type,
        "A word stands where a number is read, a number where a word is read, or another word\n\
         than the ones that are possible.\n\
         wrong: axisymmetric(True)\n\
         right: axisymmetric(true)",
    ),
    (
        Code::Range,
        "The number is outside the range in which it makes sense. Counts must be whole.\n\
         wrong: material(m, linear, 1000, 1e3, 0.5)\n\
         right: material(m, linear, 1000, 1e3, 0.49)",
    ),
    (
        Code::NotFinite,
        "A number is infinite or not a number, by division by zero, the logarithm or root of a\n\
         negative number, or overflow.\n\
         wrong: a = 1/(b - b)\n\
         right: a = if(b != 0, 1/b, 0)",
    ),
    (
        Code::NotPlace,
        "x, y, z, x0, y0, z0 are the place of a point; logs, plots, conditions and plain numbers\n\
         belong to no point.\n\
         wrong: run_while(x < 1)\n\
         right: run_while(xcm(all, x) < 1)",
    ),
    (
        Code::Protected,
        "x y z x0 y0 z0 time timestep dt PI and the results of fixes and computes are read-only.\n\
         wrong: dt = 0.001\n\
         right: set_dt(0.001)",
    ),
    (
        Code::UnknownField,
        "The dump style has no such field; the manual page of the style lists them.\n\
         wrong: dump(d, all, particle, 10, d.*.LAMMPS, velocity)\n\
         right: dump(d, all, particle, 10, d.*.LAMMPS, vx, vy)",
    ),
    (
        Code::NotCombined,
        "Method, sub-method and shape functions do not all go together.\n\
         wrong: method(ulmpm, FLIP, Bernstein-quadratic, 0.99)\n\
         right: method(ulmpm, FLIP, linear, 0.99)",
    ),
    (
        Code::Constant,
        "The condition is the same before every step: the run would never end or never start.\n\
         wrong: run_while(1 < 2)\n\
         right: run_while(time < 2)",
    ),
    (
        Code::DimensionMismatch,
        "The problem has fewer or more dimensions than this command or style needs.\n\
         wrong: dimension(1, 0, 1, 0.1) with region(d, stl, part.stl)\n\
         right: dimension(3, 0, 1, 0, 1, 0, 1, 0.1) with region(d, stl, part.stl)",
    ),
    (
        Code::Order,
        "Statements see what stands above them. The order is method, dimension, axisymmetric;\n\
         region and material, solid, group, fix and compute, run.\n\
         wrong: solid(s, region, disk, 2, m, h) above dimension(...)\n\
         right: dimension(...) above solid(s, region, disk, 2, m, h)",
    ),
    (
        Code::Duplicate,
        "An ID names one thing of its kind. Only variables may be reassigned.\n\
         wrong: region(a, ...) twice\n\
         right: region(a, ...) and region(b, ...)",
    ),
    (
        Code::GroupKind,
        "The style acts on particles only, or on nodes only.\n\
         wrong: group(g, particles, ...) with fix(f, velocity_nodes, g, 0, 0)\n\
         right: group(g, nodes, ...) with fix(f, velocity_nodes, g, 0, 0)",
    ),
    (
        Code::Missing,
        "A run needs a method, a dimension and at least one solid.\n\
         wrong: run(100) as the first line\n\
         right: run(100) below the last solid(...)",
    ),
    (
        Code::NothingLeft,
        "The region holds no particle, so the solid would be empty.\n\
         wrong: a region smaller than the distance of the particles\n\
         right: a region of several cells",
    ),
    (
        Code::TooLarge,
        "Box and cell size ask for more nodes or particles than fit into memory: mostly a wrong\n\
         unit or a cell size of the wrong power of ten.\n\
         wrong: dimension(3, 0, 1000, 0, 1000, 0, 1000, 0.1)\n\
         right: dimension(3, 0, 10, 0, 10, 0, 10, 0.1)",
    ),
    (
        Code::BadFile,
        "The file of a region or solid does not follow its format, or its surface has a gap. The\n\
         message names the line of the file where there are lines.\n\
         wrong: a mesh whose element has no area\n\
         right: a mesh that Gmsh wrote and checked",
    ),
    (
        Code::FileSystem,
        "A file or directory does not exist or cannot be written. Directories are not created.\n\
         wrong: dump(d, all, particle, 10, missing/d.*.LAMMPS, x)\n\
         right: dump(d, all, particle, 10, d.*.LAMMPS, x)",
    ),
    (
        Code::RunFailed,
        "The simulation went wrong while it ran; the message names step, time and culprit. Often\n\
         the time step is too large or a formula is not finite.\n\
         wrong: set_dt(1)\n\
         right: set_dt(auto)",
    ),
    (
        Code::Compatibility,
        "The line is an old form of Karamelo's language. It acts as ever; the warning shows how\n\
         it is written today.\n\
         old: solid(s, r, 2, m, h)\n\
         new: solid(s, region, r, 2, m, h)",
    ),
    (
        Code::ProtectedConstant,
        "Old scripts use x0, y0, z0 as variables. From here on, expressions see the constant\n\
         instead of the reference position.\n\
         old: x0 = 0.5\n\
         new: start_x0 = 0.5",
    ),
    (
        Code::EmptyGroup,
        "No particle or node lies in the region of the group, so whatever acts on it does nothing.\n\
         wrong: a region outside of every solid\n\
         right: a region that holds particles of the solid",
    ),
    (
        Code::Overlap,
        "Particles of two solids share a place, which doubles the mass there.\n\
         wrong: two regions that overlap, a solid in each\n\
         right: region(rest, difference, a, b) for one of them",
    ),
    (
        Code::CutByBox,
        "Part of the region lies outside the box; particles are made only inside.\n\
         wrong: dimension(2, 0, 1, 0, 1, 0.1) with a disk round (0, 0)\n\
         right: dimension(2, -1, 1, -1, 1, 0.1) with a disk round (0, 0)",
    ),
    (
        Code::SurplusComponent,
        "The problem has fewer dimensions than there are components; the rest does nothing.\n\
         wrong: fix(g, body_force, all, 0, 0, -9.81) in two dimensions\n\
         right: fix(g, body_force, all, 0, -9.81)",
    ),
    (
        Code::UnstableStep,
        "The time step is larger than waves allow, so the run may blow up.\n\
         wrong: set_dt(1), dt_factor(2)\n\
         right: set_dt(auto), dt_factor(0.9)",
    ),
    (
        Code::NoEffect,
        "The line is legal but changes nothing in this scene.\n\
         wrong: stress_rate(jaumann) with a total Lagrangian method\n\
         right: leave the line away",
    ),
    (
        Code::OddFile,
        "The file of a solid can be used, but holds something that is mostly a mistake: elements\n\
         that stand there twice, are turned over against the others, folded or curved.\n\
         wrong: a mesh saved with its physical groups twice\n\
         right: every element once, all with the same orientation",
    ),
    (
        Code::NotPhysical,
        "A material breaks a law of physics: sand that grows faster in shear than its friction can\n\
         pay for makes energy.\n\
         wrong: material(sand, mohr-coulomb, 2650, 1e7, 0.3, 0, 30, 40)\n\
         right: material(sand, mohr-coulomb, 2650, 1e7, 0.3, 0, 30, 5)",
    ),
    (
        Code::CommandLine,
        "`-var NAME VALUE` sets a variable before the script; the script's own assignment of that\n\
         name is skipped.\n\
         to use the script's value: start without `-var N 40`\n\
         to use another value: start with `-var N 40`",
    ),
    (
        Code::OldReference,
        "`x` is the current position of a point. Exact solutions and initial values are mostly\n\
         functions of the reference position `x0`.\n\
         current: check_solution with sin(PI*x)\n\
         reference: check_solution with sin(PI*x0)",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_an_explanation_of_its_own() {
        let codes: Vec<Code> = EXPLANATIONS.iter().map(|(code, _)| *code).collect();
        assert_eq!(codes, Code::ALL, "one each, in the order of the numbers");
        for (_, text) in EXPLANATIONS {
            assert!((2..=6).contains(&text.lines().count()), "{text}");
            assert!(text.lines().all(|line| line.len() <= 100 && !line.starts_with(' ')), "{text}");
        }
    }

    #[test]
    fn codes_are_found_in_either_case() {
        let text = explain("e0203").expect("a code");
        assert!(text.starts_with("E0203: A style does not exist in its family.\n\n"));
        assert!(text.contains("right: material(m, neo-hookean"));
        assert!(explain("E9999").is_none());
        assert!(explain("").is_none());
    }
}
