"""Tables of numbers from a user: columns with units in a CSV, Parquet, MATLAB or MCAP file.

Read in this order: ``table``, the result; ``table_file``, the choice of ``csv_table``, ``parquet_table``, ``mcap_table`` and
``matlab_table`` (``matlab_file`` decodes that format); ``header``, names and units of the columns; ``column_names``, options for
them; ``between``, a part of a record; ``faults``, faults of the numbers.
"""
