"""The page that pipeline.report.page fills in."""

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{{ title }}</title>
<style>
body { font: 15px/1.45 system-ui, "Helvetica Neue", Arial, sans-serif; color: #222; background: #fff;
  max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 1rem; }
h2 { font-size: 1.15rem; margin: 2.5rem 0 .5rem; border-top: 1px solid #ddd; padding-top: 1rem; }
h3 { font-size: 1rem; margin: 1.5rem 0 .3rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: 0; }
dt { color: #666; }
dd { margin: 0; overflow-wrap: anywhere; }
figure { margin: 1.5rem 0; }
figure img { width: 100%; height: auto; display: block; margin: .4rem 0; }
figcaption, .note { color: #555; font-size: .87rem; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: .12rem .8rem .12rem 0; white-space: nowrap; }
th { color: #666; font-weight: normal; border-bottom: 1px solid #bbb; vertical-align: bottom; white-space: normal; }
.word { text-align: left; }
pre { overflow-x: auto; font-size: .87rem; }
.off { font-weight: 600; }
.wide { overflow-x: auto; width: max-content; max-width: min(100vw - 3rem, 50vw + 28rem); }
ul.note { margin: .4rem 0 0; padding-left: 1.2rem; }
@media print { figure, tr { break-inside: avoid; } }
</style>
</head>
<body>
<h1>{{ title }}</h1>
<dl>
{% for name, value in facts %}
<dt>{{ name }}</dt><dd>{{ value }}</dd>
{% endfor %}
</dl>
{% for table in answers if table.lines %}
<h2>{{ table.title }}</h2>
<p class="note">{{ table.note }}</p>
<div class="wide"><table>
<tr>{% for name in table.header %}<th{% if loop.index < 3 %} class="word"{% endif %}>{{ name }}</th>{% endfor %}</tr>
{% for row in table.lines %}
<tr>{% for cell in row %}<td{% if loop.index < 3 %} class="word"{% endif %}>{{ cell }}</td>{% endfor %}</tr>
{% endfor %}
</table></div>
{% endfor %}
{% if again %}
<h2>The same designs once more</h2>
<p class="note">In a copy of the study file.</p>
<pre>{{ again }}</pre>
{% endif %}
{% for title, lines in troubles.items() if lines %}
<h2>{{ title }}</h2>
<ul>
{% for line in lines %}
<li>{{ line }}</li>
{% endfor %}
</ul>
{% endfor %}
<h2>Figures</h2>
{% for figure in figures %}
<figure>
<h3>{{ figure.title }}</h3>
<img alt="{{ figure.title }}. {{ figure.caption }}" src="{{ figure.source }}">
<figcaption>{{ figure.caption }}</figcaption>
</figure>
{% endfor %}
{% if tables %}
<h2>Published numbers and ours</h2>
<p class="note">Ours: mean over realizations, with the least and the largest.{{ survivors }} Ratio: ours
over theirs; a star if it is more than a third away from 1. Verdict: whether theirs, one realization, is in our range.
Reasons below each table.{{ named }}{% if verdicts %} {{ verdicts }}{% endif %}</p>
{% for table in tables %}
<h3>{{ table.title }}</h3>
<div class="wide"><table>
<tr><th class="word"></th><th class="word"></th><th>theirs</th><th>ours</th><th>[least, largest]</th><th>ratio</th>
<th class="word">verdict</th><th class="word">unit</th><th>realizations</th></tr>
{% for label, statistic, theirs, ours, spread, ratio, verdict, unit, count in table.rows %}
<tr><td class="word">{{ label }}</td><td class="word">{{ statistic }}</td>
<td>{{ theirs }}</td><td>{{ ours }}</td><td>{{ spread }}</td>
<td{% if "*" in ratio %} class="off"{% endif %}>{{ ratio }}</td>
<td class="word{% if verdict == "outside" %} off{% endif %}">{{ verdict }}</td><td class="word">{{ unit }}</td>
<td>{{ count }}</td></tr>
{% endfor %}
</table></div>
{% if table.sentences %}
<ul class="note">
{% for sentence in table.sentences %}
<li>{{ sentence }}</li>
{% endfor %}
</ul>
{% endif %}
{% endfor %}
{% endif %}
{% if periods %}
<h2>Natural periods of the whole system in water</h2>
<p class="note">Undamped, each with the added mass of its own frequency, and what moves in it: first the
largest motion, with what moves along with it (+) or against it (-).{{ held }}</p>
{% for platform, rows in periods %}
<h3>{{ platform }}</h3>
<table>
<tr><th>period [s]</th><th class="word">moves</th></tr>
{% for period, shape in rows %}
<tr><td>{{ period }}</td><td class="word">{{ shape }}</td></tr>
{% endfor %}
</table>
{% endfor %}
{% endif %}
{% if summary %}
<h2>Mean and range of every variable</h2>
<div class="wide"><table>
<tr><th class="word">variable</th><th class="word">statistic</th><th>mean</th><th>least</th><th>largest</th>
<th class="word">unit</th></tr>
{% for name, statistic, mean, least, largest, unit in summary %}
<tr><td class="word">{{ name }}</td><td class="word">{{ statistic }}</td><td>{{ mean }}</td><td>{{ least }}</td>
<td>{{ largest }}</td><td class="word">{{ unit }}</td></tr>
{% endfor %}
</table></div>
{% endif %}
</body>
</html>
"""
