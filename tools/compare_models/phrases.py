"""Words of the report for numbers and names."""


def short(value):
    return "-" if value is None else f"{value:.3g}"


def seconds(value):
    return "-" if value is None else f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def percent(value):
    if value is None:
        return "-"
    return f"{100 * value:.0f} %" if value >= 1 else f"{100 * value:.2g} %"


def listed(parts):
    parts = list(parts)
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}" if parts else "none"


def code(name):
    return f"`{name}`"


def metric_words(judged):
    if judged.value is None:
        return f"{judged.name} not measured"
    value = short(judged.value)
    if judged.ratio > 1 and value == short(judged.limit):  # missed by a hair
        value = f"{judged.value:.5g}"
    return f"{judged.name} {value} of {short(judged.limit)}"


def number_of_cases(count):
    return "1 case" if count == 1 else f"{count} cases"
