"""Claims as data: a check, a reason, a stop rule is a code with values and a sentence of spans.

`numbers` writes numbers, `spans` is the sentence, `say` builds it. Our codes are in `campaigns.codes`. Start reading at
`spans`.
"""
