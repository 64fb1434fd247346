# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Renders HTML pages from Jinja templates; every value is escaped."""
from jinja2 import Environment, FileSystemLoader, StrictUndefined


def page(folder, template, values):
    """Return the text of a page.

    :param folder: the folder of the templates, ``resource/pages``
    :param template: the name of one of them
    :param values: {name in the template: value}
    :raises jinja2.TemplateError: the template is missing, or uses a name without a value
    """
    environment = Environment(loader=FileSystemLoader(folder), autoescape=True,
                              undefined=StrictUndefined, trim_blocks=True)
    return environment.get_template(template).render(values)
