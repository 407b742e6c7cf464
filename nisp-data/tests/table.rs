//! Tables: what is accepted, what is refused, and in which words.

use std::path::Path;

use nisp_data::Table;
use proptest::prelude::*;

fn parse(text: &str) -> Table {
    Table::parse(Path::new("t.csv"), text.as_bytes()).unwrap()
}

fn refusal(text: &[u8]) -> String {
    Table::parse(Path::new("t.csv"), text).unwrap_err().to_string()
}

#[test]
fn reads_marks_comments_and_other_line_ends() {
    let table = parse("\u{feff}# made by hand\r\nt [s], q_m ,note\r\n0,1.5,a\r\n\r\n# pause\r\n1,-2e-3,b\r\n");
    assert_eq!(table.column("t").unwrap(), [0.0, 1.0]);
    assert_eq!(table.quantity("q", "m").unwrap(), [1.5, -2e-3]);
    assert_eq!(table.headers().collect::<Vec<_>>(), ["t [s]", "q_m", "note"]);
    let semicolons = parse("t;q\n0;1\n1;2\n");
    assert_eq!(semicolons.column("q").unwrap(), [1.0, 2.0]);
}

#[test]
fn finds_columns_by_name_and_unit() {
    let table = parse("t_s,q_m,dq_m_s,a [m/s^2],N_N_per_m,psi_rad_sigma0.01\n0,1,2,3,4,5\n1,1,2,3,4,5\n");
    assert_eq!(table.quantity("dq", "m/s").unwrap()[0], 2.0);
    assert_eq!(table.quantity("a", "m s^-2").unwrap()[0], 3.0);
    assert_eq!(table.quantity("N", "N/m").unwrap()[0], 4.0);
    assert_eq!(table.column("N").unwrap()[0], 4.0);
    assert_eq!(table.column("psi_rad_sigma0.01").unwrap()[0], 5.0);
    assert!(!table.has("psi"));
    assert!(table.quantity("q", "V").is_err());
}

#[test]
fn multiples_of_the_unit_are_converted() {
    let table = parse("t_ms,q [cm],psi_deg,x_m_sigma0.01\n0,1,180,1\n500,2,0,1\n");
    assert_eq!(table.quantity("t", "s").unwrap(), [0.0, 0.5]);
    assert_eq!(table.quantity("q", "m").unwrap(), [0.01, 0.02]);
    assert_eq!(table.quantity("psi", "rad").unwrap()[0], std::f64::consts::PI);
    assert_eq!(table.chosen("t", "t_ms", "s").unwrap(), [0.0, 0.5]);
    assert_eq!(table.chosen("q", "x_m_sigma0.01", "m").unwrap(), [1.0, 1.0]);
}

#[test]
fn round_brackets_hold_units_too() {
    let table = parse("t (ms),q (cm),psi (filtered)\n0,1,2\n500,2,3\n");
    assert_eq!(table.quantity("t", "s").unwrap(), [0.0, 0.5]);
    assert_eq!(table.quantity("q", "m").unwrap(), [0.01, 0.02]);
    let remarked = parse("q (raw) [mm]\n1\n2\n");
    assert_eq!(remarked.chosen("q", "q (raw) [mm]", "m").unwrap(), [1e-3, 2e-3]);
    // What is no unit says nothing of one.
    assert_eq!(table.chosen("psi", "psi (filtered)", "rad").unwrap(), [2.0, 3.0]);
}

#[test]
fn another_unit_is_refused_even_where_the_column_is_chosen() {
    let table = parse("t [s],q [kg],x [furlong],phi (V)\n0,1,2,3\n1,2,3,4\n");
    let mass = "t.csv: `q [kg]` is in kg, where `q` is in m: choose another column, or correct the header";
    assert_eq!(table.chosen("q", "q [kg]", "m").unwrap_err().to_string(), mass);
    assert_eq!(table.quantity("q", "m").unwrap_err().to_string(), mass);
    assert!(table.chosen("x", "x [furlong]", "m").unwrap_err().to_string().contains("is in furlong"));
    assert!(table.chosen("phi", "phi (V)", "rad").unwrap_err().to_string().contains("is in V"));
    // A quantity of the same name is not meant by another.
    let strange = table.quantity("psi", "rad").unwrap_err().to_string();
    assert!(strange.contains("choose one, with --column psi=HEADER"), "{strange}");
    // Nor is a time by a temperature, where a longer name is there.
    let warm = parse("x,t,temp\n0,1,2\n1,2,3\n").quantity("T", "K").unwrap_err().to_string();
    assert!(warm.contains("for instance with --column T=temp"), "{warm}");
}

#[test]
fn refuses_with_what_to_do() {
    let table = parse("t_s,q_m_sigma0,q_m_sigma0.01\n0,1,1\n1,nan,x\n");
    assert_eq!(
        table.quantity("q", "m").unwrap_err().to_string(),
        "t.csv: no column for `q` in m; choose one, for instance with --column q=q_m_sigma0 (columns: t_s, \
         q_m_sigma0, q_m_sigma0.01)"
    );
    let cell = table.column("q_m_sigma0").unwrap_err().to_string();
    assert_eq!(cell, "t.csv: line 3, column `q_m_sigma0`: `nan` is not a finite number; remove the row");
    let word = table.column("q_m_sigma0.01").unwrap_err().to_string();
    assert_eq!(word, "t.csv: line 3, column `q_m_sigma0.01`: `x` is not a number; correct it or remove the row");
    let twice = parse("q [m],q_m\n0,1\n1,2\n").column("q").unwrap_err().to_string();
    assert!(twice.contains("several columns answer to `q`: q [m], q_m; choose one"), "{twice}");
    assert_eq!(
        table.chosen("q", "q_m_sigma1", "m").unwrap_err().to_string(),
        "t.csv: no column for `q_m_sigma1`; the nearest is `q_m_sigma0`: --column q=q_m_sigma0 (columns: t_s, \
         q_m_sigma0, q_m_sigma0.01)"
    );
    let unlike = parse("v,v_V,v [V]\n0,1,2\n1,2,3\n");
    assert_eq!(unlike.chosen("v", "v_V", "V").unwrap(), [1.0, 2.0]);
    let blanks = parse("t q\n0 1\n1 2\n").quantity("t", "s").unwrap_err().to_string();
    assert!(blanks.contains("separate cells by commas, semicolons or tabs"), "{blanks}");
    assert!(refusal(b"").contains("empty"));
    assert!(refusal(b"# a\n# b\n").contains("only comments"));
    assert!(refusal(b"t,q\n0,1\n").contains("at least 2 are needed"));
    assert!(refusal(b"t,q\n0,1\n1\n").contains("line 3: 1 cells where the header has 2"));
    assert!(refusal(b"Run 3\n0;1\n1;2\n").contains("the line that begins with `Run 3` is a title"));
    let parted = refusal(b"t,T(x=0.1 m, y=0.2 m) [K],T(x=0.3 m, y=0.2 m) [K]\n0,1,2\n1,2,3\n");
    assert!(parted.contains("put a header with a comma in it into quotation marks"), "{parted}");
    assert!(refusal(b"0,1\n0,1\n1,2\n").contains("put a line of column names above it"));
    assert!(refusal(b"t,q\n0,\xff\n").contains("not UTF-8 text (byte 6)"));
    assert!(Table::read("/nowhere/t.csv").unwrap_err().to_string().contains("no such file"));
    assert!(Table::read("/").unwrap_err().to_string().contains("is a folder"));
}

#[test]
fn a_unit_may_be_chosen_where_the_header_has_none() {
    let table = parse("t,pos,v [m/s]\n0,1,1\n1,2,2\n");
    assert_eq!(table.chosen("q", "pos [mm]", "m").unwrap(), [1e-3, 2e-3]);
    assert_eq!(table.chosen("q", "pos", "m").unwrap(), [1.0, 2.0]);
    let other = table.chosen("q", "pos [K]", "m").unwrap_err().to_string();
    assert!(other.contains("`pos [K]` is in K, where `q` is in m"), "{other}");
    // What a header says is not overruled.
    assert!(table.chosen("q", "v [mm/s]", "m/s").is_err() && table.chosen("q", "speed [mm]", "m").is_err());
}

#[test]
fn thousands_are_not_taken_for_ones() {
    let q = |cells: [&str; 4]| {
        let rows: Vec<String> = (0..4).zip(cells).map(|(t, cell)| format!("{t};{cell}\n")).collect();
        parse(&format!("t;q\n{}", rows.concat())).quantity("q", "m").map_err(|error| error.to_string())
    };
    let doubt = q(["998", "999", "1.000", "1.001"]).unwrap_err();
    assert!(doubt.contains("line 4, column `q`: `1.000` stands in a column of whole numbers up to 999"), "{doubt}");
    assert!(q(["0", "-640", "-1,280", "2.560"]).is_err());
    assert_eq!(q(["998", "999", "1.000", "1.0010"]).unwrap(), [998.0, 999.0, 1.0, 1.001]);
    assert_eq!(q(["1", "1.125", "1.250", "2"]).unwrap(), [1.0, 1.125, 1.25, 2.0]);
    assert_eq!(q(["120", "120.125", "130,250", "140"]).unwrap(), [120.0, 120.125, 130.25, 140.0]);
    assert_eq!(q(["0.125", "100", "200", "300"]).unwrap(), [0.125, 100.0, 200.0, 300.0]);
    for cell in ["1,234.5", "1.234,5", "1'234", "1 234,5", "1.234.567"] {
        let said = q(["1", "2", cell, "4"]).unwrap_err();
        assert!(said.contains("without marks between thousands"), "{said}");
    }
    assert!(q(["1", "2", "2026-01-02", "4"]).unwrap_err().contains("is a date"));
    assert!(q(["1", "2", "12.05.2026", "4"]).unwrap_err().contains("is a date"));
}

/// 1970 begins 54 years of 365 days and 13 leap days before 2024.
#[test]
fn dates_become_seconds_once_their_beginning_is_known() {
    let seconds = |first: &str, second: &str| {
        let mut table = parse(&format!("t,q\n{first},1\n{second},2\n"));
        assert!(table.quantity("t", "s").is_err());
        table.count_from(table.begins().unwrap());
        table.quantity("t", "s").unwrap()
    };
    assert_eq!(seconds("2026-01-02 03:04:05", "2026-01-03T03:04:05.25"), [0.0, 86_400.25]);
    assert_eq!(seconds("2024-02-28 12:00", "2024-03-01 12:00:00Z"), [0.0, 2.0 * 86_400.0]);
    assert_eq!(seconds("9:59:59", "10:00"), [0.0, 1.0]);
    let mut split = parse("date,t,q\n31.12.2025,23:59:50,1\n01.01.2026,00:00:10,2\n");
    split.count_from(split.begins().unwrap());
    assert_eq!(split.quantity("t", "s").unwrap(), [0.0, 20.0]);
    let mut later = parse("t,q\n1970-01-03 00:00:00,1\n2024-01-01 00:00:00,2\n");
    later.count_from(std::time::SystemTime::UNIX_EPOCH);
    assert_eq!(later.quantity("t", "min").unwrap(), [2880.0, (54.0 * 365.0 + 13.0) * 1440.0]);
    assert!(later.quantity("t", "K").unwrap_err().to_string().contains("`t` holds dates, where `t` is in K"));
    // What may be meant by a temperature is no date.
    let log = parse("timestamp,room T [degC]\n2026-01-01 00:00:00,1\n2026-01-01 00:00:01,2\n");
    let said = log.quantity("T", "K").unwrap_err().to_string();
    assert!(said.contains("--column 'T=room T [degC]'"), "{said}");
    assert_eq!(seconds("02.01.2026 03:04", "3.1.2026 3:05:30"), [0.0, 86_490.0]);
    assert_eq!(seconds("2024/02/28", "2024-03-01"), [0.0, 2.0 * 86_400.0]);
    assert_eq!(seconds("2026-01-02T03:04:05+01:00", "2026-01-02T00:04:05-0230"), [0.0, 1800.0]);
    // One of the cells tells the order of day and month.
    assert_eq!(seconds("12/31/2025 11:59:50 PM", "1/1/2026 12:00:10 AM"), [0.0, 20.0]);
    assert_eq!(seconds("31/12/2025 12:30", "01/01/2026 00:30"), [0.0, 43_200.0]);
    assert_eq!(seconds("3/14/2026 11:59 AM", "3/14/2026 12:01 pm"), [0.0, 120.0]);
    assert_eq!(seconds("9:59:59 AM", "1:00 PM"), [0.0, 3.0 * 3600.0 + 1.0]);
    for rows in ["01/02/2026,1\n02/02/2026,2", "03/04/2026 10:00,1\n03/04/2026 10:01,2"] {
        let either = parse(&format!("t,q\n{rows}\n")).quantity("t", "s").unwrap_err().to_string();
        assert!(either.contains("the day of the month first, or the month; write them like `2026-01-31`"), "{either}");
    }
    for other in [
        "13:00 PM",
        "02/01/2026 03:04",
        "2.1.26",
        "2026-13-01 00:00:00",
        "31.02.2026",
        "2026-01-02 1:00+x",
        "2026-01-02 1:00+99:99",
        "2026-01-02 1:00+992147483647",
        "2026-01-02 1:00ZZ",
        "soon",
    ] {
        assert!(parse(&format!("t,q\n2026-01-01 00:00:00,1\n{other},2\n")).begins().is_none(), "{other}");
    }
}

#[test]
fn columns_of_one_name_are_refused_even_where_they_are_chosen() {
    let table = parse("t,v_V,note,v_V,note\n0,1,a,2,b\n1,2,a,3,b\n");
    let words = "t.csv: columns 2 and 4 are both named `v_V`; rename one of them";
    assert_eq!(table.quantity("v", "V").unwrap_err().to_string(), words);
    assert_eq!(table.chosen("v", "v_V", "V").unwrap_err().to_string(), words);
    assert_eq!(table.column("v_V").unwrap_err().to_string(), words);
    assert_eq!(table.require_increasing("v").unwrap_err().to_string(), words);
    // Remarks may have any name.
    assert_eq!(table.column("t").unwrap(), [0.0, 1.0]);
    let thrice = parse("v,v,v\n0,1,2\n1,2,3\n").chosen("v", "v", "V").unwrap_err().to_string();
    assert!(thrice.contains("columns 1, 2 and 3 are named `v`"), "{thrice}");
}

#[test]
fn a_quotation_mark_that_is_not_closed_swallows_no_rows() {
    let message = refusal(b"t,v,note\n0,1,ok\n1,2,\"oops\n2,3,ok\n3,4,ok\n");
    assert_eq!(message, "t.csv: line 3: a cell goes on in the next line; close its quotation mark");
    assert_eq!(parse("\"t [s]\",v\n0,\"1\"\n1,2\n").quantity("t", "s").unwrap(), [0.0, 1.0]);
}

#[test]
fn time_must_rise() {
    assert!(parse("t,q\n0,1\n1,1\n").require_increasing("t").is_ok());
    let fall = parse("t_s,q\n0,1\n# pause\n2,1\n1,1\n").require_increasing("t").unwrap_err().to_string();
    assert_eq!(fall, "t.csv: line 5, column `t_s`: 1 comes after 2; sort the rows by this column");
    let of = |times: &mut dyn Iterator<Item = usize>| {
        let rows: String = times.map(|t| format!("{t},1\n")).collect();
        parse(&format!("t,q\n{rows}")).require_increasing("t").unwrap_err().to_string()
    };
    let twice = of(&mut (0..20).chain(19..30));
    assert!(
        twice.ends_with("line 22, column `t`: the value 19 is there twice; keep one row for each value"),
        "{twice}"
    );
    let rounded = of(&mut (0..30).map(|row| row / 3));
    assert!(rounded.contains("twice, as are 20 of 30: they were rounded; give them with more digits"), "{rounded}");
}

#[test]
fn dates_that_do_not_rise_are_told_as_dates() {
    let mut table = parse("t,q\n2026-01-02 00:00:10,1\n2026-01-02 00:00:05,2\n");
    table.count_from(table.begins().unwrap());
    let said = table.require_increasing("t").unwrap_err().to_string();
    assert!(said.contains("line 3, column `t`: 2026-01-02 00:00:05 comes after 2026-01-02 00:00:10; sort"), "{said}");
}

#[test]
fn the_repository_data_reads() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    let observed = Table::read(root.join("pendulum/run_01_obs.csv")).unwrap();
    assert_eq!(observed.rows(), 201);
    observed.require_increasing("t").unwrap();
    assert_eq!(observed.column("q_m_sigma0.01").unwrap()[0], -0.01031523);
    let truth = Table::read(root.join("pendulum/run_01_truth.csv")).unwrap();
    assert_eq!(truth.quantity("f", "N").unwrap()[0], 0.0744481331);
}

#[test]
fn headers_that_speak_of_no_known_unit_are_not_taken_for_another() {
    let table = parse("t (Min),T [kelvins],u [furlong],v (measured),w [in]\n0,20,1,2,3\n1,21,2,3,4\n");
    let fault = |name: &str, header: &str, unit: &str| table.chosen(name, header, unit).unwrap_err().to_string();
    assert!(fault("w", "w [in]", "mm").contains("is `inch` meant?"), "{}", fault("w", "w [in]", "mm"));
    assert!(fault("t", "t (Min)", "s").contains("is `min` meant?"), "{}", fault("t", "t (Min)", "s"));
    assert!(fault("u", "u [furlong]", "m").contains("no such unit is known"));
    assert_eq!(table.chosen("v", "v (measured)", "m").unwrap(), [2.0, 3.0]);
    // Nothing is suggested that would be refused.
    let missing = table.quantity("T", "K").unwrap_err().to_string();
    assert!(missing.contains("no such unit is known"), "{missing}");
}

#[test]
fn degrees_celsius_and_fahrenheit_become_kelvins() {
    let table = parse("t,T_degC,wall [°F],n [rpm]\n0,20,68,60\n1,-40,-40,120\n");
    let close = |values: Vec<f64>, expected: [f64; 2]| values.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9);
    assert!(close(table.quantity("T", "K").unwrap(), [293.15, 233.15]));
    assert!(close(table.quantity("wall", "K").unwrap(), [293.15, 233.15]));
    assert!(close(table.quantity("n", "rad/s").unwrap(), [std::f64::consts::TAU, 2.0 * std::f64::consts::TAU]));
}

#[test]
fn spreadsheets_write_decimal_commas_and_cells_that_were_not_measured() {
    let table = parse("t_s;q_m\n0;1,5\n0,5;n/a\n1;-2,25e-1\n1,5;NA\n");
    assert_eq!(table.quantity("t", "s").unwrap(), [0.0, 0.5, 1.0, 1.5]);
    let found = table.measured("q", "m").unwrap();
    assert_eq!((found[0], found[2]), (1.5, -0.225));
    assert!(found[1].is_nan() && found[3].is_nan());
    let fault = |cell: &str| parse(&format!("t,q\n0,{cell}\n1,2\n")).measured("q", "m").unwrap_err().to_string();
    assert!(fault("\"1,5\"").contains("write the decimal comma as a point"));
    assert!(fault("2026-03-01 12:00:07").contains("is a date or a time of day"));
    assert!(fault("broken").contains("is not a number; correct it"));
}

#[test]
fn titles_above_a_header_and_units_below_it_are_known() {
    let german = parse("Datenlogger 5, Raum 2\nSeriennummer;77\nOrt;Keller\nZeit;Temp, innen\ns;°C\n0;1,5\n1;2,5\n");
    assert_eq!(german.headers().collect::<Vec<_>>(), ["Zeit [s]", "Temp, innen [°C]"]);
    assert_eq!(german.chosen("T", "Temp, innen [°C]", "K").unwrap(), [274.65, 275.65]);
    let title = parse("Run 3, by hand\nt,q,note\n0,1,a; b\n1,2,a; b\n");
    assert_eq!(title.quantity("q", "m").unwrap(), [1.0, 2.0]);
    let units = parse("t,q,n\n(ms),mm,-\n0,1,1\n1000,2,1\n");
    assert_eq!(
        (units.quantity("t", "s").unwrap(), units.quantity("q", "m").unwrap()),
        (vec![0.0, 1.0], vec![0.001, 0.002])
    );
    assert_eq!(parse("t [s],q [mm]\ns,mm\n0,1\n1,2\n").quantity("q", "m").unwrap(), [0.001, 0.002]);
    let two = parse("t [s],q [mm]\ns,m\n0,1\n1,2\n").quantity("q", "m").unwrap_err().to_string();
    assert!(two.contains("its header says mm, and the line below m"), "{two}");
    assert!(two.contains("line 2"), "{two}");
    // Remarks make rows that are mostly words, and hold marks that part no cells.
    let remarks = parse("t,q,who,what,why\n0,1,I,a; b,c\n1,2,I,a; b,c\n2,3,,; ,\n");
    assert_eq!(remarks.quantity("q", "m").unwrap(), [1.0, 2.0, 3.0]);
    let named = parse("name,t,q,remark\na,0,5,x\nb,1,6,\nc,2,7,\n");
    assert_eq!(named.quantity("q", "m").unwrap(), [5.0, 6.0, 7.0]);
    let phases = parse("who,phase,t,q\nA,A,0,5\nA,,1,6\nB,,3,8\n");
    assert_eq!(phases.quantity("t", "s").unwrap(), [0.0, 1.0, 3.0]);
    assert_eq!(parse("n,t,q\n-,s,mm\n1,0,5\n2,1,6\n").quantity("q", "m").unwrap(), [0.005, 0.006]);
    // A line of units with one that is not known is still one, and says so where its column is asked for.
    let unknown = parse("t,q,n\ns,mm,Upm\n0,5,1\n1,6,1\n");
    assert_eq!(unknown.quantity("q", "m").unwrap(), [0.005, 0.006]);
    let said = unknown.quantity("n", "1/s").unwrap_err().to_string();
    assert!(said.contains("`n [Upm]` is in Upm") && said.contains("no such unit is known"), "{said}");
    assert_eq!(parse("t_s,q_mm\ns,mm\n0,5\n1,6\n").quantity("q", "m").unwrap(), [0.005, 0.006]);
    let many = parse("t;q;a;b;c;e\n0,5;5,1;u;v;w;x\n1,5;6,1;u;v;w;x\n");
    assert_eq!(many.quantity("q", "m").unwrap(), [5.1, 6.1]);
    // Words that are no units are cells that cannot be read, as they always were.
    let longer = parse("Run 3, by me, in May\nt,q\n0,1\n1,2\n");
    assert_eq!(longer.quantity("q", "m").unwrap(), [1.0, 2.0]);
    let export = parse("Export;31.01.2026\nt;q\n0;1\n1;2\n");
    assert_eq!(export.quantity("q", "m").unwrap(), [1.0, 2.0]);
    // What says units is the header, and words below it are cells.
    let words = parse("t [s];q [mm]\nstart;OVLD\n0;1\n1;2\n");
    assert!(words.quantity("q", "m").unwrap_err().to_string().contains("line 2"));
    let station = parse("Station;Rhine\nt [s];q [mm]\n0;1\n1;2\n");
    assert_eq!(station.quantity("q", "m").unwrap(), [0.001, 0.002]);
    let long = parse(&format!("{}t,q\n0,1\n1,2\n2,3\n", "key: value\n".repeat(100)));
    assert_eq!(long.quantity("q", "m").unwrap(), [1.0, 2.0, 3.0]);
    assert!(parse("t,q\n0,yes\n1,2\n").quantity("q", "m").unwrap_err().to_string().contains("line 2"));
    assert!(parse("t,q\nna,na\n1,2\n").quantity("q", "m").unwrap_err().to_string().contains("line 2"));
}

#[test]
fn a_column_for_each_gauge_becomes_a_row_for_each_measurement() {
    let unfolded = |text: &str| parse(text).with_rows_of_gauges(&["t", "x", "y"]);
    let wide =
        unfolded("t [ms];T(x=10 mm) [K];T(x=25mm) [K];p(x=25 mm);out;cal(L=1)\n0;1;2;5;8;1\n1000;3;;6;9;1\n").unwrap();
    assert_eq!(wide.headers().collect::<Vec<_>>(), ["x [mm]", "t [ms]", "T [K]", "p", "out", "cal(L=1)"]);
    assert_eq!(wide.quantity("t", "s").unwrap(), [0.0, 1.0, 0.0, 1.0]);
    assert_eq!(wide.quantity("x", "m").unwrap(), [0.01, 0.01, 0.025, 0.025]);
    let text = |values: Vec<f64>| values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    assert_eq!(text(wide.measured("T", "K").unwrap()), "1 3 2 NaN");
    assert_eq!(text(wide.measured("p", "1").unwrap()), "NaN NaN 5 6");
    assert_eq!(text(wide.quantity("out", "1").unwrap()), "8 9 8 9");
    assert!(wide.quantity("T", "K").unwrap_err().to_string().contains("line 3, column `T [K]`: the cell is empty"));
    let plate = unfolded("t,\"w (x=0, y=1)\",w(x=2;y=3)\n0,1,2\n1,3,4\n").unwrap();
    let (x, y) = (plate.column("x").unwrap(), plate.column("y").unwrap());
    assert_eq!((x, y), (&[0.0, 0.0, 2.0, 2.0][..], &[1.0, 1.0, 3.0, 3.0][..]));
    assert_eq!(plate.column("w").unwrap(), [1.0, 3.0, 2.0, 4.0]);
    // Brackets that name no coordinate that is lacking are a matter of the header alone.
    for table in ["t,q,q(t=0)\n0,5,1\n1,6,2\n", "t,q(gain=2)\n0,5\n1,6\n", "x,t,T,T(x=1)\n0,0,1,2\n1,1,1,2\n"] {
        let kept = unfolded(table).unwrap();
        assert!(kept.headers().eq(parse(table).headers()), "{table}");
    }
    let refused = |headers: &str| unfolded(&format!("{headers}\n0;1;2\n1;3;4\n")).unwrap_err().to_string();
    for (headers, what) in [
        ("t;T(x=1 m);T(x=20 mm)", "`T(x=1 m)` and `T(x=20 mm)` do not name the same coordinates in the same units"),
        ("t;T(x=0);T(x=0,1)", "the place in `T(x=0,1)` cannot be read"),
        ("t;T(x=1);T(x 2)", "the place in `T(x 2)` cannot be read"),
        ("t;T(x=0.1);T(x=0.10)", "`T(x=0.1)` and `T(x=0.10)` are at the same place"),
        ("t;T(x=1) [degC];T(x=2)", "are one quantity in two units"),
        ("t;T [K];T(x=2) [K]", "`T [K]` says no place beside `T(x=2) [K]`, which does"),
    ] {
        assert!(refused(headers).contains(what), "{}", refused(headers));
    }
}

proptest! {
    #[test]
    fn garbage_never_panics(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        if let Ok(table) = Table::parse(Path::new("g"), &bytes) {
            let headers: Vec<String> = table.headers().map(str::to_string).collect();
            for header in headers {
                let _ = table.require_increasing(&header);
            }
        }
    }

    #[test]
    fn almost_csv_never_panics(text in "[tq0-9,;#\"\\[\\]_ .\\n\\re+-]{0,200}") {
        if let Ok(table) = Table::parse(Path::new("g"), text.as_bytes()) {
            let _ = (table.column("t"), table.quantity("q", "m"), table.require_increasing("q"));
        }
    }

    #[test]
    fn numbers_come_back_to_the_bit(values in proptest::collection::vec(any::<f64>().prop_filter("finite", |v| v.is_finite()), 2..40)) {
        let mut table = Table::empty();
        table.push("x", "m/s^2", &values).unwrap();
        table.push("y", "", &values).unwrap();
        let mut bytes = Vec::new();
        table.write_to(&mut bytes).unwrap();
        let back = Table::parse(Path::new("t"), &bytes).unwrap();
        let bits = |numbers: &[f64]| numbers.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&back.quantity("x", "m/s^2").unwrap()), bits(&values));
        prop_assert_eq!(bits(back.column("y").unwrap()), bits(&values));
    }
}

#[test]
fn cells_that_were_not_measured_are_gaps_where_gaps_may_be() {
    let table = parse("t_s,q_mm,p,r\n0,1,,inf\n1,,2,1\n2,nan,3,1\n");
    let measured = table.measured("q", "m").unwrap();
    assert!(measured[0] == 1e-3 && measured[1].is_nan() && measured[2].is_nan(), "{measured:?}");
    assert!(table.quantity("q", "m").unwrap_err().to_string().contains("line 3"), "only where gaps may be");
    assert!(table.measured("r", "1").unwrap_err().to_string().contains("not a finite number"));
    let chosen = table.chosen_measured("x", "p", "1").unwrap();
    assert!(chosen[0].is_nan() && chosen[1..] == [2.0, 3.0]);
    let lacks = |name: &str| table.lacks(name, ["t", "q"].into_iter());
    assert!(lacks("x") && !lacks("q") && !lacks("p"));
    // What is meant by another name is not meant by a longer or shorter one.
    let short = parse("t [s],q [deg]\n0,1\n1,1\n");
    assert!(short.lacks("th", ["t", "q"].into_iter()) && !short.lacks("th", std::iter::empty()));
}
