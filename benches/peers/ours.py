"""What the peers are compared with: the table of `cargo bench --bench generic`."""


def rates_of_ours(arguments):
    """Gradient rates of generated code, by operator and width, from the table that a script was given; none without one."""
    rates = {}
    for path in arguments[1:2]:
        with open(path, encoding="utf-8") as table:
            for line in table:
                cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
                if len(cells) > 5 and cells[1].isdigit():
                    rates[cells[0], int(cells[1])] = float(cells[4])
    return rates
